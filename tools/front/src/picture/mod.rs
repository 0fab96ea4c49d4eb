//! Pictures of heights: hypsometric tints with shading, and colour maps for other planes.
//!
//! Rasters are row-major f32 with row 0 in the north; NaN is a void.

pub mod colour;
mod colour_map;
mod field;
pub mod geoid;
mod png;
mod relief;
mod shade;
mod tint;

pub use colour_map::{ColourMap, ColourMapInput, colour_map};
pub use png::{png_bytes, write_png};
pub use relief::{PictureInput, shaded_relief};
pub use tint::{Tint, Tints};

/// An 8-bit sRGB picture, row 0 at the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbImage {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Red, green, blue of each pixel.
    pub pixels: Vec<[u8; 3]>,
}

/// A raster that does not fit its own description: the calling code is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// No pixels, or not a multiple of the supersampling.
    #[error("raster of {width} x {height}: both must be positive multiples of {multiple}")]
    Size {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// What they must be multiples of.
        multiple: usize,
    },
    /// A slice whose length is not the raster's.
    #[error("{what} has {length} values, must have {expected}")]
    Length {
        /// Which slice.
        what: &'static str,
        /// Its length.
        length: usize,
        /// What the raster needs.
        expected: usize,
    },
}

fn check_size(width: usize, height: usize, multiple: usize, values: usize) -> Result<(), PictureError> {
    let fits = |side: usize| side > 0 && multiple > 0 && side.is_multiple_of(multiple);
    if !fits(width) || !fits(height) {
        return Err(PictureError::Size { width, height, multiple });
    }
    match width.checked_mul(height) {
        Some(expected) if expected == values => Ok(()),
        expected => {
            Err(PictureError::Length { what: "raster", length: values, expected: expected.unwrap_or(usize::MAX) })
        }
    }
}
