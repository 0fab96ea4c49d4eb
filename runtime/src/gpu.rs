//! The GPU backend: the device, the atlas in its memory, and the kernels' pipelines.

mod atlas;
mod canvas;
mod device;
mod frame;
mod heights;
mod kernel;
mod lists;
mod over_pages;
mod paper;
mod pending;
mod picture;
mod present;
mod read;
mod readback;
mod shading;
mod shadow_masks;
mod shadow_points;
mod targets;
mod tessellate;
mod timestamps;

pub use atlas::Atlas;
pub use device::{AdapterChoice, Device, DeviceError};
pub use frame::Gpu;
pub use heights::Heights;
pub use present::HostTargets;
pub use shadow_masks::ShadowMasks;
pub use shadow_points::ShadowPoints;
