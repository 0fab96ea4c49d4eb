//! Where the paper's shadows are to be had, and what they read.

use relief_formats::file::FormatError;
use relief_formats::grid::Grid;
use relief_shaders::shadow::dense::nodes_of;
use relief_shaders::shadow::paper::PaperMap;

use super::{Settings, Shadow};
use crate::planet::Planet;
use crate::view::ViewError;

/// Largest map exponent of a plane whose shadows are found by the paper's kernel.
const MOST_M: u32 = 13;

impl Settings {
    /// Refuses the paper's shadows where they are not to be had: texels of a globe differ in size.
    pub(crate) fn check_kernel(&self, grid: Grid) -> Result<(), ViewError> {
        let good = self.shadow != Shadow::Paper || (grid.plane && grid.m <= MOST_M);
        if good { Ok(()) } else { Err(refused("over a plane of at most 8192 x 8192 nodes; elsewhere take `exact`")) }
    }
}

/// The error of the paper's kernel where it cannot be had.
pub(crate) fn refused(rule: &'static str) -> ViewError {
    ViewError::Kernel { what: "shadow kernel `paper`", rule }
}

/// The pyramids of paper 001, from level 0 of a plane.
pub(crate) fn paper_map(planet: &Planet) -> Result<PaperMap, FormatError> {
    let uniform = planet.uniform();
    let side = 1usize << uniform.m;
    let mut heights_m = nodes_of(&uniform, planet.tiles(), 0)?;
    // The far edges repeat the nodes before them.
    for row in 1..side {
        heights_m.copy_within(row * (side + 1)..row * (side + 1) + side, row * side);
    }
    heights_m.truncate(side * side);
    let units = (1u64 << (31 - uniform.m)) as f32;
    Ok(PaperMap::new(uniform.m, [uniform.unit_x_m * units, uniform.unit_y_m * units], heights_m))
}
