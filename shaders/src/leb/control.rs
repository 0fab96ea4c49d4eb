//! The counts that steer the passes on the GPU.

use bytemuck::{Pod, Zeroable};

use super::tessellate::Stats;

/// `struct LebControl` of `wgsl/lib/leb_control.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Control {
    /// Triangles of the list that is read.
    pub count_in: u32,
    /// Triangles asked to be put in the list that is written.
    pub count_out: u32,
    /// Relief triangles asked to be drawn; more than there is room for when `overflow` is set.
    pub relief: u32,
    /// 1 when a list was full.
    pub overflow: u32,
    /// Triangles judged.
    pub tested: u32,
    /// Triangles culled.
    pub culled: u32,
    /// Passes that had something to do.
    pub passes: u32,
    /// 1 when the horizon hides.
    pub horizon: u32,
}

impl Control {
    /// As the twin tells it.
    #[must_use]
    pub fn stats(&self) -> Stats {
        Stats { passes: self.passes, tested: self.tested, culled: self.culled, overflow: self.overflow != 0 }
    }
}

/// `struct LebArgs` of `wgsl/leb_args.wgsl`: arguments of the next pass, and of the draw.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Args {
    /// Workgroups of the next `leb_pass`.
    pub groups: [u32; 3],
    /// Zero.
    pub padding: u32,
    /// Three times the relief triangles.
    pub vertices: u32,
    /// 1.
    pub instances: u32,
    /// 0.
    pub first_vertex: u32,
    /// 0.
    pub first_instance: u32,
}

impl Args {
    /// Where in the buffer the arguments of the indirect draw start, bytes.
    pub const DRAW_OFFSET: u64 = 16;
}
