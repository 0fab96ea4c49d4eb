//! The runtime: from a `.relief` file and a camera to a mesh, a frame and a shadow mask.
//!
//! An embeddable component (paper 003): it takes the host's `wgpu` device or makes its own, draws
//! into the host's texture views, and knows nothing of windows or sockets. A [`planet::Planet`]
//! is a mapped file; a resident set (on a GPU or in RAM) holds the tiles that are in use; any
//! number of [`view::View`]s are drawn from one resident set.

pub mod cpu;
pub mod frame;
pub mod geotiff;
pub mod gpu;
pub mod planet;
pub mod report;
pub mod residency;
pub mod shadow;
pub mod sun;
pub mod view;
