//! From pixels to nodes: kernels, and where each node lies among a source's pixels.
//!
//! A node's height is a function of its position alone: the same bits at every level that has
//! the node, in every window that holds it, on every thread. Kernels are therefore chosen from
//! the source and the finest level it is sampled at, never from the level asked for.

pub(crate) mod axis;
pub(crate) mod bounds;
mod coverage;
pub(crate) mod cylindrical;
pub(crate) mod kernel;
pub(crate) mod lattice;
pub(crate) mod projection;
pub(crate) mod scattered;
pub(crate) mod separable;
