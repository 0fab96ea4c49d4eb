//! From elevation rasters to a validated `.relief` file: the library behind `relief-bake`.

pub mod bake;
pub mod cog;
pub mod commands;
pub mod junit;
pub mod lattice;
mod progress;
pub mod report;
pub mod resample;
pub mod source;
pub mod validate;
