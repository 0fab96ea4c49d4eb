//! Both backends against f64 and against each other.
#![allow(clippy::unwrap_used, reason = "a test ends at the first thing that goes wrong")]

mod cpu_frame;
mod gpu_frame;
mod gpu_heights;
mod overlays;
mod paper_shadows;
mod sunlight;
mod support;
