//! Why a frame was not drawn.

use relief_formats::file::FormatError;

use crate::gpu::DeviceError;
use crate::residency::CapacityError;
use crate::view::ViewError;

/// A frame that was not drawn.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The view: the caller corrects it.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The device: the caller makes it anew, or takes another backend. Other views on other
    /// devices go on.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The file's coarsest tiles.
    #[error(transparent)]
    File(#[from] FormatError),
    /// The atlas is allowed too little.
    #[error(transparent)]
    Capacity(#[from] CapacityError),
}
