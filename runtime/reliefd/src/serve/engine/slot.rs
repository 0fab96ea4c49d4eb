//! A camera as the engine sees it: the latest view that was asked for, and what became of it.

use std::sync::Arc;
use std::time::Instant;

use relief_protocol::MOST_UNACKNOWLEDGED;
use relief_protocol::error::Fault;
use relief_protocol::view::View;

use super::picture::Picture;

/// Who gets the pictures of a slot; called on the engine's thread, so it hands work on.
pub type Sink = Arc<dyn Fn(Result<Picture, Fault>) + Send + Sync>;

/// A view that was asked for.
#[derive(Clone)]
pub struct Ask {
    /// The asker's number for it.
    pub view: u64,
    /// What is looked at.
    pub what: Arc<View>,
    /// Also the triangles.
    pub mesh: bool,
    /// Also the places that pixels show.
    pub places: bool,
    /// When it was asked.
    pub arrived: Instant,
    /// None: pictures follow as tiles come in. Else one picture, once nothing is missing or at this time.
    pub until: Option<Instant>,
}

/// A camera.
pub(super) struct Slot {
    /// Whose it is; clients take turns.
    pub client: u64,
    pub sink: Sink,
    ask: Option<Ask>,
    /// The ask was not drawn yet.
    fresh: bool,
    /// Tiles that the last picture of the view lacked; none when it was whole.
    lacking: Option<usize>,
    /// A better picture than the last can be drawn.
    better: bool,
    sent: u64,
    acknowledged: u64,
    /// A picture is being drawn or handed over.
    busy: bool,
    /// When it was drawn last, counted in draws of all slots.
    pub drawn: u64,
}

impl Slot {
    pub fn new(client: u64, sink: Sink) -> Self {
        Self {
            client,
            sink,
            ask: None,
            fresh: false,
            lacking: None,
            better: false,
            sent: 0,
            acknowledged: 0,
            busy: false,
            drawn: 0,
        }
    }

    /// The latest view wins.
    pub fn ask(&mut self, ask: Ask) {
        self.ask = Some(ask);
        self.fresh = true;
        self.lacking = None;
    }

    /// True while a picture is drawn or handed over.
    pub fn is_busy(&self) -> bool {
        self.busy
    }

    /// True while its view lacks tiles.
    pub fn is_lacking(&self) -> bool {
        self.lacking.is_some()
    }

    /// The same view again, as after a new file.
    pub fn again(&mut self) {
        self.fresh = self.ask.is_some();
    }

    pub fn acknowledge(&mut self, seq: u64) {
        self.acknowledged = self.acknowledged.max(seq.min(self.sent));
    }

    pub fn is_ready(&self, now: Instant) -> bool {
        if self.ask.is_none() || self.busy || self.sent - self.acknowledged >= MOST_UNACKNOWLEDGED {
            return false;
        }
        self.fresh || self.better || self.due().is_some_and(|due| due <= now)
    }

    /// So many of its tiles are still to come, and none will where loading is stuck.
    pub fn loaded(&mut self, left: usize, stuck: bool) {
        let (Some(lacking), Some(ask)) = (&mut self.lacking, &self.ask) else { return };
        self.better |= match ask.until {
            None => left < *lacking,
            Some(_) => left == 0 || stuck,
        };
        *lacking = left;
    }

    /// Takes the view to be drawn, and its picture's number.
    pub fn start(&mut self, draws: u64) -> Option<(Ask, u64)> {
        let ask = self.ask.clone()?;
        self.busy = true;
        self.fresh = false;
        self.better = false;
        self.drawn = draws;
        Some((ask, self.sent + 1))
    }

    /// A picture was drawn: lacking tiles or not, sent or kept back.
    pub fn drawn(&mut self, lacking: usize, sent: bool) {
        if !self.fresh {
            self.lacking = (lacking > 0).then_some(lacking);
        }
        self.sent += u64::from(sent);
        // What was kept back is not handed over.
        self.busy = sent;
    }

    /// The picture was handed over.
    pub fn free(&mut self) {
        self.busy = false;
    }

    /// The view cannot be drawn, or its one picture is done.
    pub fn forget(&mut self) {
        if !self.fresh {
            self.ask = None;
        }
        self.lacking = None;
        self.better = false;
        self.busy = false;
    }

    /// A time at which it is ready whatever comes.
    pub fn due(&self) -> Option<Instant> {
        self.lacking.and(self.ask.as_ref()).and_then(|ask| ask.until)
    }
}

#[cfg(test)]
pub(super) mod tests;
