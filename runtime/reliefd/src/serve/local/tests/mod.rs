//! The local transport, with the client as the other end.
#![allow(clippy::unwrap_used, reason = "tests")]

mod socket;
mod torn;
mod viewers;
