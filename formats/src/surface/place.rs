//! Where a point lies on a level's grid: its tile, its cell, and the fractions within the cell.

use crate::body::Body;
use crate::geodesy::{AngleError, T_NORTH};
use crate::grid::Grid;
use crate::tile::{TILE_CELLS, TileKey};

/// A point that a grid does not have: the caller corrects it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlaceError {
    /// A longitude or latitude that names no place.
    #[error(transparent)]
    Angle(#[from] AngleError),
    /// A coordinate outside a plane, or not a number.
    #[error("{axis} {value}: must lie within {low} to {high}")]
    Outside {
        /// `X` or `Y`.
        axis: &'static str,
        /// What was given, CRS units.
        value: f64,
        /// Coordinate of the first node.
        low: f64,
        /// Coordinate of the far edge.
        high: f64,
    },
    /// A fixed-point coordinate beyond the North Pole or a plane's edge.
    #[error("{axis} {value}: must be at most 2147483648")]
    Fixed {
        /// `S` or `T`.
        axis: &'static str,
        /// What was given.
        value: u32,
    },
    /// A level that has no tiles.
    #[error("level {level}: must be 0 (finest) to {coarsest}")]
    Level {
        /// What was given.
        level: u32,
        /// The coarsest level.
        coarsest: u32,
    },
    /// Longitude and latitude asked of a plane, or X and Y of a globe.
    #[error("a plane is asked by X and Y of its CRS, a globe by longitude and latitude")]
    Kind,
}

/// A point on one level of a grid. A point on a border belongs to the cell east and north of it,
/// at the far edges to the last cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The tile.
    pub tile: TileKey,
    /// Column of the cell in the tile, 0 to 255.
    pub column: u8,
    /// Row of the cell in the tile, 0 to 255.
    pub row: u8,
    /// Share of the cell west of the point, 0 to 1.
    pub u: f64,
    /// Share of the cell south of the point, 0 to 1.
    pub v: f64,
}

impl Place {
    /// The place of longitude (any number of turns) and geodetic latitude, degrees. Nodes are hit
    /// exactly; elsewhere the error is below 1e-15 of a turn.
    ///
    /// # Errors
    /// Angles that name no place, a level that is not stored, a plane's grid.
    pub fn from_deg(grid: Grid, level: u32, lon_deg: f64, lat_deg: f64) -> Result<Self, PlaceError> {
        if grid.plane {
            return Err(PlaceError::Kind);
        }
        if !lon_deg.is_finite() {
            return Err(AngleError::Longitude(lon_deg).into());
        }
        if !(-90.0..=90.0).contains(&lat_deg) {
            return Err(AngleError::Latitude(lat_deg).into());
        }
        check_level(grid, level)?;
        // The remainder is exact. A sum just below 0 rounds to a whole turn, which is 0 again.
        let turn = (lon_deg % 360.0 + 180.0) / 360.0;
        let turn = turn - turn.floor();
        let turn = if turn < 1.0 { turn } else { 0.0 };
        let x = turn * f64::from(grid.width(level));
        let y = (lat_deg + 90.0) / 180.0 * f64::from(grid.height(level));
        Ok(Self::from_cells(grid, level, x, y))
    }

    /// The place of X and Y in a plane's CRS. The far edges (one spacing beyond the last node)
    /// belong to it.
    ///
    /// # Errors
    /// A point outside, a level that is not stored, a globe.
    pub fn from_xy(body: &Body, grid: Grid, level: u32, x: f64, y: f64) -> Result<Self, PlaceError> {
        let &Body::Plane { x0, y0, dx, dy, .. } = body else { return Err(PlaceError::Kind) };
        if !grid.plane {
            return Err(PlaceError::Kind);
        }
        check_level(grid, level)?;
        let cells = |axis, value: f64, low: f64, spacing: f64, count: u32| {
            let cells = (value - low) / spacing;
            if (0.0..=f64::from(count)).contains(&cells) {
                Ok(cells / f64::from(1u32 << level))
            } else {
                Err(PlaceError::Outside { axis, value, low, high: low + spacing * f64::from(count) })
            }
        };
        let x = cells("X", x, x0, dx, grid.width(0))?;
        let y = cells("Y", y, y0, dy, grid.height(0))?;
        Ok(Self::from_cells(grid, level, x, y))
    }

    /// The place of fixed-point (S, T), exact.
    ///
    /// # Errors
    /// T (on a plane also S) above 2^31, a level that is not stored.
    pub fn from_fixed(grid: Grid, level: u32, s: u32, t: u32) -> Result<Self, PlaceError> {
        check_level(grid, level)?;
        if t > T_NORTH {
            return Err(PlaceError::Fixed { axis: "T", value: t });
        }
        if grid.plane && s > T_NORTH {
            return Err(PlaceError::Fixed { axis: "S", value: s });
        }
        let cell = f64::from(31 - grid.m + level).exp2();
        Ok(Self::from_cells(grid, level, f64::from(s) / cell, f64::from(t) / cell))
    }

    /// From coordinates in cells of the level: x in 0..=W, y in 0..=H.
    #[must_use]
    pub fn from_cells(grid: Grid, level: u32, x: f64, y: f64) -> Self {
        let split = |value: f64, count: u32| {
            let index = (value.floor() as u32).min(count - 1);
            (index, value - f64::from(index))
        };
        let ((i, u), (j, v)) = (split(x, grid.width(level)), split(y, grid.height(level)));
        Self {
            tile: TileKey::new(level, i / TILE_CELLS, j / TILE_CELLS),
            column: (i % TILE_CELLS) as u8,
            row: (j % TILE_CELLS) as u8,
            u,
            v,
        }
    }
}

fn check_level(grid: Grid, level: u32) -> Result<(), PlaceError> {
    let coarsest = grid.root_level();
    if level <= coarsest { Ok(()) } else { Err(PlaceError::Level { level, coarsest }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_names_no_place_is_refused() {
        let (globe, plane) = (Grid::new(10, false), Grid::new(10, true));
        assert!(Place::from_deg(globe, 0, f64::NAN, 0.0).is_err());
        assert!(Place::from_deg(globe, 0, 0.0, 90.1).is_err());
        assert_eq!(Place::from_deg(globe, 3, 0.0, 0.0), Err(PlaceError::Level { level: 3, coarsest: 2 }));
        assert_eq!(Place::from_deg(plane, 0, 0.0, 0.0), Err(PlaceError::Kind));
        assert_eq!(Place::from_xy(&Body::earth(), globe, 0, 0.0, 0.0), Err(PlaceError::Kind));
        assert!(Place::from_fixed(globe, 0, u32::MAX, T_NORTH + 1).is_err());
        assert!(Place::from_fixed(plane, 0, T_NORTH + 1, 0).is_err());
        assert!(Place::from_fixed(plane, 0, T_NORTH, T_NORTH).is_ok());
    }

    #[test]
    fn a_hair_west_of_the_seam_is_the_last_cell_or_the_seam() {
        let grid = Grid::new(8, false);
        let west = Place::from_deg(grid, 0, -180.0 - 1e-9, 0.0).unwrap();
        assert_eq!((west.tile.x, west.column), (1, 255));
        let closer = Place::from_deg(grid, 0, 180.0f64.next_down(), 0.0).unwrap();
        assert!(closer.tile.x == 1 && closer.u < 1.0 || closer.tile.x == 0 && closer.u == 0.0);
    }
}
