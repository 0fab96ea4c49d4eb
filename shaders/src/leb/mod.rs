//! Scheme `leb`: adaptive tessellation by longest-edge bisection (DESIGN section 9).
//!
//! A pass takes a list of triangles; each is culled, drawn as a relief triangle, or halved. Passes
//! go on until the list is empty. Nothing is kept from frame to frame.

pub mod active;
pub mod cull;
pub mod params;
pub mod region;
pub mod tessellate;
pub mod triangle;
pub mod virtual_cells;

pub use params::Params;
pub use tessellate::{Corner, Mesh, ReliefTriangle, Stats, tessellate};
pub use triangle::{Node, Triangle};
