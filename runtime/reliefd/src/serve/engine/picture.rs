//! What the engine made of a view.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_protocol::payload::Stats;
use relief_runtime::frame::{self, Frame, ReliefTriangle};
use relief_runtime::planet::Planet;
use relief_runtime::view::View;

use super::board::Board;
use super::slot::Ask;

/// A picture, not yet packed. While it or its hold lives its camera is not drawn again.
pub struct Picture {
    /// The asker's number of the view.
    pub number: u64,
    /// The picture's own number among those of its camera.
    pub seq: u64,
    /// The planet it shows.
    pub planet: Arc<Planet>,
    /// The view.
    pub view: View,
    /// Sub-solar longitude and latitude, or azimuth and elevation, degrees.
    pub sun_deg: [f64; 2],
    /// The pixels.
    pub frame: Frame,
    /// The triangles, where they were asked for.
    pub mesh: Option<Vec<ReliefTriangle>>,
    /// False while a better picture of the same view is to come.
    pub complete: bool,
    /// What it cost.
    pub stats: Stats,
    /// Lets the camera be drawn again.
    pub(super) hold: Arc<Hold>,
}

impl Picture {
    /// While this lives, too, the camera is not drawn again.
    pub fn hold(&self) -> Arc<Hold> {
        Arc::clone(&self.hold)
    }
}

/// Says at its end that a picture was handed over.
pub struct Hold {
    pub(super) board: Arc<Board>,
    pub(super) slot: u64,
}

impl Drop for Hold {
    fn drop(&mut self) {
        self.board.handed_over(self.slot);
    }
}

/// What a frame cost, whose drawing began then.
pub(super) fn stats(stats: &frame::Stats, ask: &Ask, began: Instant) -> Stats {
    let ms = |time: Duration| (time.as_secs_f64() * 1e6).round() / 1e3;
    let fetches = stats.fetches;
    let passes: BTreeMap<String, f64> =
        stats.pass_ms.iter().map(|&(name, ms)| (name.to_owned(), (ms * 1e3).round() / 1e3)).collect();
    Stats {
        triangles: stats.triangles,
        tiles_resident: stats.tiles_resident as u64,
        tiles_missing: stats.tiles_missing as u64,
        draw_ms: ms(began.elapsed()),
        wait_ms: ms(began.saturating_duration_since(ask.arrived)),
        pass_ms: passes,
        fetches_per_ray: (fetches.rays > 0).then(|| (fetches.heights + fetches.extremes) as f64 / fetches.rays as f64),
        holes: stats.overflow,
    }
}
