//! `relief-bake` as a user runs it, and what it promises of the files it makes.
#![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

#[macro_use]
mod common;

mod bake;
mod diff;
mod export;
mod inspect;
mod preview;
mod probe;
mod report;
mod validate;
