//! The client against a daemon that says what a test wants it to.
#![allow(clippy::unwrap_used, reason = "tests")]
#![cfg(target_os = "linux")]

mod fake;
mod faults;
mod rings;
mod viewer;
