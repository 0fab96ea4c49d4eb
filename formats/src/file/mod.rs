//! The container: header, sections, tile index, tail (SPEC, "File").

pub mod error;
pub mod header;
pub mod index;
mod map;
pub mod metadata;
pub mod reader;
pub mod section;
pub mod temporary;
pub mod writer;

pub use error::FormatError;
pub use header::Header;
pub use index::{Entry, Plane};
pub use metadata::Metadata;
pub use reader::Relief;
