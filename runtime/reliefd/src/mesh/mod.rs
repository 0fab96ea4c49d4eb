//! A frame's triangles as a mesh of the camera's surroundings: for files and for viewers.

pub mod glb;
pub mod packed;
mod vertices;

pub use glb::glb;
