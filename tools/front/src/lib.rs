//! What `relief-bake` and `reliefd` show people: errors, output files, pictures, plots, pages.
//!
//! No GDAL and no GPU: both programs stand on this crate.

pub mod bytes;
pub mod error;
pub mod gltf;
pub mod picture;
pub mod publish;
pub mod sheet;
pub mod staging;
pub mod stderr;
pub mod stdout;
pub mod window;
