//! `reliefd serve` over HTTP, as scripts, browsers and systemd see it.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

mod answers;
mod client;
mod configured;
mod daemon;
mod described;
mod ending;
mod figures;
mod guarded;
mod managed;
mod refused;
mod schema;
