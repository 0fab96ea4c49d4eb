//! `reliefd` as a user runs it.
#![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

mod mask;
mod probe;
mod program;
mod refused;
mod render;
