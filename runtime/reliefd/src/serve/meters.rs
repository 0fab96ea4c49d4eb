//! Figures for the operator.

use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

use relief_protocol::error::Code;
use relief_protocol::payload::Stats;

/// Counts since the daemon started.
#[derive(Debug, Default)]
pub struct Meters {
    viewers: AtomicI64,
    frames: AtomicU64,
    faults: AtomicU64,
}

impl Meters {
    /// Viewers came or went.
    pub fn viewers(&self, change: i64) {
        self.viewers.fetch_add(change, Ordering::Relaxed);
    }

    /// A picture was drawn.
    pub fn drew(&self, planet: &str, stats: &Stats) {
        tracing::trace!(planet, triangles = stats.triangles, draw_ms = stats.draw_ms, "drew");
        self.frames.fetch_add(1, Ordering::Relaxed);
    }

    /// Tiles came in.
    pub fn loaded(&self, planet: &str, resident: usize, loaded: usize) {
        tracing::trace!(planet, resident, loaded, "loaded");
    }

    /// A viewer was told that something is wrong.
    pub fn fault(&self, code: Code) {
        tracing::debug!(?code, "fault");
        self.faults.fetch_add(1, Ordering::Relaxed);
    }
}
