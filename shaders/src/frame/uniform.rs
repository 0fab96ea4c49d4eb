//! The mesh without adaptation: all cells of a level. What adaptive schemes are measured against.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use crate::leb::{Corner, ReliefTriangle};
use crate::pages::Pages;

/// Which mesh: `struct UniformMesh` of `wgsl/frame_uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct UniformMesh {
    /// The level.
    pub level: u32,
    /// Its columns of cells.
    pub columns: u32,
    /// Its rows of cells.
    pub rows: u32,
    /// Zero.
    pub padding: u32,
}

/// Two triangles for each cell of `level` (one for a cell at a pole), the whole map, heights from
/// the finest page at `level` or coarser.
#[must_use]
pub fn uniform(pages: &Pages<'_>, level: u32) -> Vec<ReliefTriangle> {
    let planet = pages.planet;
    let shift = 31 - planet.m + level;
    let (columns, rows) = (1u32 << (planet.m + 1 - planet.plane - level), 1u32 << (planet.m - level));
    let corner = |i: u32, j: u32| {
        let (s, t) = ((u64::from(i) << shift) as u32, j << shift);
        Corner { s, t, height_m: pages.height_m(level, s, t), level: level as i32 }
    };
    (0..rows)
        .into_par_iter()
        .flat_map_iter(|j| {
            (0..columns).flat_map(move |i| {
                let [sw, se, nw, ne] = [corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)];
                let south = (j > 0 || planet.plane != 0).then_some([sw, se, nw]);
                let north = (j + 1 < rows || planet.plane != 0).then_some([ne, nw, se]);
                south.into_iter().chain(north)
            })
        })
        .collect()
}
