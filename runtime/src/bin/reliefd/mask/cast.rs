//! Rays from every node of a level.

use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;
use relief_front::error::ToolError;
use relief_front::window::Rectangle;
use relief_runtime::planet::Planet;
use relief_runtime::view::Sun;
use relief_shaders::shadow::dense::Dense;
use relief_shaders::shadow::shadow_exact;
use relief_shaders::shadow::sun::sun_local;
use relief_shaders::shadow::sweep::{PlaneNodes, sweep_mask};

/// Fixed-point longitude 0, where ECEF's x axis points.
const GREENWICH: u32 = 1 << 31;
/// Most memory for a level with its bounds.
const MOST_BYTES: u64 = 8 << 30;

/// A level that is held whole.
pub struct Caster {
    planet: Arc<Planet>,
    dense: Dense,
}

impl Caster {
    /// Reads a level that the file has.
    ///
    /// # Errors
    /// A level too large to hold, or a damaged tile.
    pub fn new(planet: Arc<Planet>, path: &Path, level: u32) -> Result<Self, ToolError> {
        let grid = planet.grid();
        let bytes = 20 * u64::from(grid.width(level)) * u64::from(grid.height(level)) / 3;
        if bytes > MOST_BYTES {
            return Err(ToolError::usage(
                format!("--level {level}: {} GB of heights and bounds", bytes >> 30),
                format!("a level takes at most {} GB", MOST_BYTES >> 30),
                "give a coarser --level",
            ));
        }
        let dense = Dense::from_tiles(&planet.uniform(), planet.tiles(), level).map_err(ToolError::of_file(path))?;
        Ok(Self { planet, dense })
    }

    /// The mask of a rectangle of nodes, rows from the north.
    pub fn mask(&self, sun: &Sun, radius_deg: f64, rectangle: Rectangle) -> Vec<u8> {
        match *sun {
            Sun::Local(towards) if radius_deg == 0.0 => self.swept(towards.map(|c| c as f32), rectangle),
            _ => self.cast(sun, radius_deg, rectangle),
        }
    }

    /// Rays of one direction, all at once.
    fn swept(&self, towards: [f32; 3], rectangle: Rectangle) -> Vec<u8> {
        let planet = self.planet.uniform();
        let units = f64::from(1u32 << (31 - planet.m + self.dense.level()));
        let nodes = PlaneNodes {
            samples: self.dense.nodes_m(),
            unit_m: 1.0,
            columns: self.dense.columns(),
            rows: self.dense.rows(),
            spacing_m: [planet.unit_x_m, planet.unit_y_m].map(|unit_m| f64::from(unit_m) * units),
        };
        let (lit, _) = sweep_mask::<false, f32>(&nodes, towards);
        let (column, columns) = (rectangle.column as usize, rectangle.columns as usize);
        let rows = (rectangle.row..rectangle.row + rectangle.rows).rev();
        rows.flat_map(|y| &lit[y as usize * nodes.columns + column..][..columns]).map(|&lit| 255 * lit).collect()
    }

    /// A ray from each node, on its own.
    fn cast(&self, sun: &Sun, radius_deg: f64, rectangle: Rectangle) -> Vec<u8> {
        let (planet, level) = (self.planet.uniform(), self.dense.level());
        let shift = 31 - planet.m + level;
        let radius_rad = radius_deg.to_radians() as f32;
        let columns = self.dense.columns() as i64;
        let mut mask = vec![0; rectangle.columns as usize * rectangle.rows as usize];
        mask.par_chunks_mut(rectangle.columns as usize).enumerate().for_each(|(k, out)| {
            let y = rectangle.row + rectangle.rows - 1 - k as u32;
            let heights_m = self.dense.row_m(y as usize);
            let mut relief = &self.dense;
            for (at, out) in (rectangle.column..).zip(out) {
                let x = at.rem_euclid(columns) as u32;
                let place = [x << shift, y << shift];
                let towards = match *sun {
                    Sun::Ecef(v) => sun_local(v.map(|c| c as f32), GREENWICH, place[0], place[1]),
                    Sun::Local(v) => v.map(|c| c as f32),
                };
                let light =
                    shadow_exact(&planet, &mut relief, place, heights_m[x as usize], level, towards, radius_rad);
                *out = (light.visible * 255.0).round() as u8;
            }
        });
        mask
    }
}
