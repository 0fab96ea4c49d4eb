//! Sources of the kernels, put together, parsed and validated at build.

include!(concat!(env!("OUT_DIR"), "/kernels.rs"));
