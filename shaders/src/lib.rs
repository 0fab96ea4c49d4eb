//! WGSL kernels for planetary relief, their twins on the CPU, and what both share.
//!
//! Each file of `wgsl/lib/` has a twin of the same name here: the same functions, in f32, in the
//! same order of work. The twins are the reference in the tests and the backend without a GPU.

pub mod angle;
pub mod frame;
pub mod kernels;
pub mod leb;
pub mod oracle;
pub mod pages;
pub mod paper;
pub mod planet;
pub mod position;
pub mod ray;
pub mod shadow;
