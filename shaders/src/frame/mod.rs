//! A frame: relief triangles drawn to places, places shaded to colours.
//!
//! The GPU draws with its rasteriser (`wgsl/frame_draw.wgsl`) and shades with a kernel
//! (`wgsl/frame_shade.wgsl`); here are their twins.

mod clip;
pub mod ground;
pub mod raster;
pub mod shade;
pub mod style;
pub mod uniform;

use bytemuck::{Pod, Zeroable};

pub use raster::{Places, draw};
pub use shade::{Shaded, shade};
pub use style::{Overlay, Style};
pub use uniform::uniform;

/// A corner of a relief triangle: `struct Corner` of `wgsl/lib/frame_corner.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Corner {
    /// Fixed point.
    pub s: u32,
    /// Fixed point.
    pub t: u32,
    /// Height, metres.
    pub height_m: f32,
    /// Level of detail; below 0 inside a level-0 cell.
    pub level: i32,
}

/// Three corners, counter-clockwise seen from outside.
pub type ReliefTriangle = [Corner; 3];
