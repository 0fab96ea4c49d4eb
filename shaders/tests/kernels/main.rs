//! The kernels and their twins: laid out alike, alike in what they draw and shade on an adapter,
//! and true to what they promise.
#![allow(clippy::unwrap_used, reason = "a test ends at the first thing that goes wrong")]

mod gpu;
mod layout;
mod page_set;
mod shadow;
mod tessellation;
