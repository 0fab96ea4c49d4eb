//! A frame: relief triangles drawn to places, places shaded to colours.
//!
//! The GPU draws with its rasteriser (`wgsl/frame_draw.wgsl`) and shades with a kernel
//! (`wgsl/frame_shade.wgsl`); here are their twins.

mod clip;
pub mod ground;
pub mod light;
pub mod overlay;
pub mod raster;
pub mod sea;
pub mod shade;
pub mod style;
pub mod uniform;

pub use raster::{Places, draw};
pub use shade::{Fetches, Maps, Shaded, shade};
pub use style::{Overlay, Shadow, Style};
pub use uniform::uniform;
