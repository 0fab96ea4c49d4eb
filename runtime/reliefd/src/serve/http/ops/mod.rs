//! What whoever runs the daemon asks.

pub mod health;
pub mod metrics;
