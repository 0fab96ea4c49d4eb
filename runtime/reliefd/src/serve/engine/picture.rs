//! What the engine made of a view.

use std::sync::Arc;

use relief_protocol::payload::Stats;
use relief_runtime::frame::{Frame, ReliefTriangle};
use relief_runtime::planet::Planet;
use relief_runtime::view::View;

use super::board::Board;

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
