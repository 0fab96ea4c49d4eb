//! The GPU backend: the device, the atlas in its memory, and the kernels' pipelines.

mod atlas;
mod device;
mod heights;
mod kernel;
mod readback;

pub use atlas::Atlas;
pub use device::{AdapterChoice, Device, DeviceError};
pub use heights::Heights;
