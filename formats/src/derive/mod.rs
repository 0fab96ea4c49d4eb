//! Planes that follow from the nodes: filtered means, extremes, deviations.
//!
//! Everything here is a pure function of padded arrays, in integers, so that a plane can be
//! rebuilt and compared bit for bit on any machine. Level k is worked out from level k - 1 and a
//! few summaries of what lies below:
//!
//! | module | result of level k | from |
//! |---|---|---|
//! | [`mip`] | filtered heights of level k + 1 | those of level k, one node of padding |
//! | [`extremes`] | (min, max) of S_0 per cell of level k + 1 | nodes of level 0, or extremes of k - 1 |
//! | [`interval`] | range of S_0 - S_k per cell of level k | nodes and intervals of level max(0, k - 3) |
//! | [`deviation`] | codes of the nodes new at level k | nodes and intervals of level max(0, k - 3), codes of k - 1 |
//! | [`virtual_cells`] | codes that stand for level -1 where k = 0 | nodes of level 0 |
//! | [`local`] | a predictor of those codes | nodes of level k alone |
//! | [`crown`] | codes of the levels above the root's | what the last stage hands on |
//!
//! [`block`] runs them level by level over one block of the map.

pub mod block;
pub mod code;
pub mod crown;
pub mod deviation;
mod distances;
pub mod extremes;
pub mod field;
mod finest;
pub mod interval;
mod interval_wide;
mod kernel;
mod lanes;
pub mod local;
pub mod mip;
mod parted;
pub mod virtual_cells;

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;

pub use block::{Absent, Base, Below, Block, LevelPlanes, derive_block, padding};
pub use code::{decode_deviation, encode_deviation};
pub use field::{Field, Window};
pub use local::local_deviation;
