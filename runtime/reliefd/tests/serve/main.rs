//! `reliefd serve` under load and in trouble, over real sockets: who offends is told, everyone else
//! goes on, nothing leaks.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

mod balance;
mod daemon;
mod damaged;
mod disk;
mod half_open;
mod hostile;
mod many;
mod raw;
mod replaced;
mod slow;
mod truncated;
mod turns;
mod viewer;
