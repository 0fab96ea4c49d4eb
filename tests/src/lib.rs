//! What the tests of several crates share: sample files, and programs run to their end.
#![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

pub mod folder;
pub mod plane;
pub mod png;
pub mod program;
pub mod sample_file;
