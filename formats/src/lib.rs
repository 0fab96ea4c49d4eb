//! The `.relief` file and what its numbers mean.
//!
//! No GDAL, no GPU, no async: this crate is the bottom of the workspace. `SPEC.md` beside it
//! describes the bytes; the modules here follow its sections.

pub mod body;
pub mod codec;
pub mod derive;
pub mod file;
pub mod geodesy;
pub mod grid;
pub mod mesh;
pub mod surface;
pub mod tile;
pub mod tile_planes;
pub mod tiles;

// The sample files of the whole-program tests name this crate from outside.
#[cfg(test)]
extern crate self as relief_formats;
#[cfg(test)]
#[path = "../../tests/src/sample_file.rs"]
mod sample_file;
