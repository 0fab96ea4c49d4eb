//! The counts that steer the passes on the GPU.

use bytemuck::{Pod, Zeroable};

use super::Stats;

/// `struct PaperControl` of `wgsl/lib/paper_lists.wgsl`. All zero before `paper_start`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Control {
    /// Patches of the list that is read.
    pub count_in: u32,
    /// Patches asked to be put in the list that is written.
    pub count_out: u32,
    /// Triangles asked to be drawn, fillers included.
    pub relief: u32,
    /// 1 when a list was full.
    pub overflow: u32,
    /// Patches that came about.
    pub tested: u32,
    /// Patches of them that cannot be seen.
    pub culled: u32,
    /// Passes that had something to do.
    pub passes: u32,
    /// 1 when the horizon hides.
    pub horizon: u32,
    /// Patches that were split.
    pub split: u32,
    /// Fillers asked to be drawn.
    pub fillers: u32,
    /// Zero.
    pub padding: [u32; 2],
}

impl Control {
    /// What the tessellation did, once its last `leb_args` has run.
    #[must_use]
    pub fn stats(&self) -> Stats {
        Stats {
            passes: self.passes,
            tested: self.tested,
            culled: self.culled,
            split: self.split,
            relief: self.relief - self.fillers.min(self.relief),
            fillers: self.fillers,
            overflow: self.overflow != 0 || self.count_in != 0,
        }
    }
}
