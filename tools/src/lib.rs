//! From elevation rasters to a validated `.relief` file: the library behind `relief-bake`.

pub mod bake;
pub mod commands;
pub mod error;
pub mod gltf;
pub mod picture;
pub mod publish;
pub mod resample;
pub mod source;
