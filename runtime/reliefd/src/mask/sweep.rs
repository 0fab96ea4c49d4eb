//! A level of a plane in RAM, and the masks that sweeps make of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use relief_formats::file::FormatError;
use relief_formats::tiles::Tiles;
use relief_front::window::Rectangle;
use relief_runtime::planet::Planet;
use relief_shaders::shadow::dense::{nodes_as, tiles_of_level};
use relief_shaders::shadow::sweep::{PlaneNodes, sweep_mask};

/// A level of a plane in RAM.
pub struct Sweep {
    planet: Arc<Planet>,
    level: u32,
    nodes: Nodes,
}

/// (columns + 1) x (rows + 1) heights in steps, south row first.
enum Nodes {
    /// Above a base, where they span no more: half the memory.
    Narrow { samples: Vec<u16>, base_q: i32 },
    /// As they are: all that f32 holds exactly.
    Wide(Vec<f32>),
}

impl Sweep {
    /// Reads a level.
    ///
    /// # Errors
    /// A damaged tile.
    pub fn new(planet: Arc<Planet>, level: u32) -> Result<Self, FormatError> {
        let relief = planet.relief();
        let tiles = tiles_of_level(relief, level);
        let header = relief.header();
        let nodes = match narrow(&tiles, level, [header.min_q, header.max_q])? {
            Some(nodes) => nodes,
            None => Nodes::Wide(nodes_as(&tiles, level, |q| q as f32)?),
        };
        drop(tiles);
        Ok(Self { planet, level, nodes })
    }

    /// The mask of a rectangle of nodes for rays of one direction (unit vector east, north, up), all
    /// at once: 0 or 255, rows from the north.
    pub fn mask(&self, towards: [f32; 3], rectangle: Rectangle) -> Vec<u8> {
        let (uniform, grid) = (self.planet.uniform(), self.planet.grid());
        let units = f64::from(1u32 << (31 - uniform.m + self.level));
        let (columns, rows) = (grid.width(self.level) as usize, grid.height(self.level) as usize);
        let spacing_m = [uniform.unit_x_m, uniform.unit_y_m].map(|unit_m| f64::from(unit_m) * units);
        let unit_m = uniform.step_m;
        let lit = match &self.nodes {
            Nodes::Narrow { samples, base_q } => {
                let base = *base_q as f32;
                sweep_mask::<false, u16>(&PlaneNodes { samples, base, unit_m, columns, rows, spacing_m }, towards).0
            }
            Nodes::Wide(samples) => {
                let nodes = PlaneNodes { samples, base: 0.0, unit_m, columns, rows, spacing_m };
                sweep_mask::<false, f32>(&nodes, towards).0
            }
        };
        cut(lit, columns, rectangle)
    }
}

/// A level whose heights lie within bounds that a 16-bit step spans; none where they do not.
fn narrow(tiles: &Tiles<'_>, level: u32, [base_q, most_q]: [i32; 2]) -> Result<Option<Nodes>, FormatError> {
    if most_q.saturating_sub(base_q) > i32::from(u16::MAX) {
        return Ok(None);
    }
    // Interpolated heights may lie beyond the bounds of those that are stored.
    let outside = AtomicBool::new(false);
    let samples = nodes_as(tiles, level, |q| {
        u16::try_from(q.saturating_sub(base_q)).unwrap_or_else(|_| {
            outside.store(true, Ordering::Relaxed);
            0
        })
    })?;
    Ok((!outside.into_inner()).then_some(Nodes::Narrow { samples, base_q }))
}

/// Cuts a rectangle out of a mask of 0 and 1 with rows from the south, in place: a second mask would
/// be as large.
fn cut(mut lit: Vec<u8>, stride: usize, rectangle: Rectangle) -> Vec<u8> {
    let Rectangle { column, row, columns, rows } = rectangle;
    let (column, row, columns, rows) = (column as usize, row as usize, columns as usize, rows as usize);
    for k in 0..rows {
        let from = (row + k) * stride + column;
        lit.copy_within(from..from + columns, k * columns);
    }
    lit.truncate(rows * columns);
    for k in 0..rows / 2 {
        let (south, north) = lit.split_at_mut((rows - 1 - k) * columns);
        south[k * columns..][..columns].swap_with_slice(&mut north[..columns]);
    }
    lit.iter_mut().for_each(|lit| *lit *= 255);
    lit
}

#[cfg(test)]
mod tests;
