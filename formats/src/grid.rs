//! The node grid (node-registered, as the papers say) and its fixed-point angles.
//!
//! Node (i, j) of level 0 of a globe lies AT longitude -180 + 360 i / W and latitude
//! -90 + 180 j / H degrees, W = 2^(m+1), H = 2^m. Column W is column 0, row 0 is the South Pole,
//! row H the North Pole. A plane has W = H = 2^m and no wrap; its row H and column W repeat the
//! edge. A cell is the quad between four nodes; level k keeps every 2^k-th node.

use crate::tile::{TILE_CELLS, TileKey};

/// Smallest and largest map exponent a file may have.
pub const M_RANGE: std::ops::RangeInclusive<u32> = 8..=20;

/// Cells of one level, and how its edges close.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// The map exponent: 2^m rows of cells at level 0.
    pub m: u32,
    /// True for a plane (2^m columns, no wrap), false for a globe (2^(m+1) columns, wrapped).
    pub plane: bool,
}

impl Grid {
    /// A globe's or a plane's grid.
    #[must_use]
    pub const fn new(m: u32, plane: bool) -> Self {
        Self { m, plane }
    }

    /// Columns of cells at `level`; also the number of distinct node columns.
    #[must_use]
    pub const fn width(&self, level: u32) -> u32 {
        (1 << (self.m + !self.plane as u32)) >> level
    }

    /// Rows of cells at `level`.
    #[must_use]
    pub const fn height(&self, level: u32) -> u32 {
        (1 << self.m) >> level
    }

    /// The coarsest stored level: there the whole map is 2 x 1 tiles (a plane: one tile).
    #[must_use]
    pub const fn root_level(&self) -> u32 {
        self.m - TILE_CELLS.ilog2()
    }

    /// Columns of tiles at `level`.
    #[must_use]
    pub const fn tiles_x(&self, level: u32) -> u32 {
        self.width(level) / TILE_CELLS
    }

    /// Rows of tiles at `level`.
    #[must_use]
    pub const fn tiles_y(&self, level: u32) -> u32 {
        self.height(level) / TILE_CELLS
    }

    /// True when the key names a tile of this grid.
    #[must_use]
    pub const fn contains(&self, key: TileKey) -> bool {
        key.level <= self.root_level() && key.x < self.tiles_x(key.level) && key.y < self.tiles_y(key.level)
    }

    /// The node of the map that stands for (x, y) of `level`: a globe is wrapped at the seam and
    /// carried over the poles half a turn on, a plane is mirrored at its edges (SPEC, "Beyond the
    /// edge"). Rows end at H, columns at W - 1 (plane: W). Reaches one map's width beyond.
    #[must_use]
    pub fn home_node(&self, level: u32, x: i32, y: i32) -> (i32, i32) {
        let (w, h) = (self.width(level) as i32, self.height(level) as i32);
        let mirror = |v: i32, end: i32| {
            if v < 0 {
                -v
            } else if v > end {
                2 * end - v
            } else {
                v
            }
        };
        if self.plane {
            return (mirror(x, w).clamp(0, w), mirror(y, h).clamp(0, h));
        }
        let turned = if (0..=h).contains(&y) { x } else { x + w / 2 };
        (turned.rem_euclid(w), mirror(y, h).clamp(0, h))
    }

    /// [`Grid::home_node`] for cells.
    #[must_use]
    pub fn home_cell(&self, level: u32, x: i32, y: i32) -> (i32, i32) {
        let (w, h) = (self.width(level) as i32, self.height(level) as i32);
        let mirror = |v: i32, count: i32| {
            if v < 0 {
                -1 - v
            } else if v >= count {
                2 * count - 1 - v
            } else {
                v
            }
        };
        if self.plane {
            return (mirror(x, w).clamp(0, w - 1), mirror(y, h).clamp(0, h - 1));
        }
        let turned = if (0..h).contains(&y) { x } else { x + w / 2 };
        (turned.rem_euclid(w), mirror(y, h).clamp(0, h - 1))
    }

    /// Longitude of node column `i` of `level` in degrees, -180 at column 0. Globe only.
    #[must_use]
    pub fn lon_deg(&self, level: u32, i: i64) -> f64 {
        -180.0 + 360.0 * i as f64 / f64::from(self.width(level))
    }

    /// Geodetic latitude of node row `j` of `level` in degrees, -90 at row 0. Globe only.
    #[must_use]
    pub fn lat_deg(&self, level: u32, j: i64) -> f64 {
        -90.0 + 180.0 * j as f64 / f64::from(self.height(level))
    }

    /// Node spacing in latitude at `level`, degrees (equal to that in longitude). Globe only.
    #[must_use]
    pub fn spacing_deg(&self, level: u32) -> f64 {
        180.0 / f64::from(self.height(level))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_the_exponent() {
        let globe = Grid::new(13, false);
        assert_eq!((globe.width(0), globe.height(0)), (16384, 8192));
        assert_eq!((globe.root_level(), globe.tiles_x(5), globe.tiles_y(5)), (5, 2, 1));
        let plane = Grid::new(8, true);
        assert_eq!((plane.width(0), plane.height(0), plane.root_level()), (256, 256, 0));
    }

    #[test]
    fn the_map_goes_on_beyond_its_edge() {
        let globe = Grid::new(9, false);
        assert_eq!(globe.home_node(0, -3, 5), (1021, 5));
        assert_eq!(globe.home_node(0, 10, -2), (522, 2));
        assert_eq!(globe.home_node(1, 10, 258), (266, 254));
        assert_eq!(globe.home_cell(0, 0, -1), (512, 0));
        assert_eq!(globe.home_cell(0, 1024, 512), (512, 511));
        let plane = Grid::new(8, true);
        assert_eq!(plane.home_node(0, -2, 258), (2, 254));
        assert_eq!(plane.home_cell(0, 256, -1), (255, 0));
    }

    #[test]
    fn poles_and_seam_are_exact() {
        let globe = Grid::new(20, false);
        assert_eq!(globe.lat_deg(0, 0), -90.0);
        assert_eq!(globe.lat_deg(0, 1 << 20), 90.0);
        assert_eq!(globe.lon_deg(0, 1 << 20), 0.0);
    }
}
