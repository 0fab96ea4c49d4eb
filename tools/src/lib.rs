//! From elevation rasters to a validated `.relief` file: the library behind `relief-bake`.

pub mod bake;
pub mod cog;
pub mod commands;
pub mod error;
pub mod gltf;
pub mod junit;
pub mod lattice;
pub mod picture;
pub mod publish;
pub mod report;
pub mod resample;
pub mod source;
pub mod staging;
pub mod stdout;
pub mod validate;
