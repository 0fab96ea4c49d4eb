//! The engine's thread.

mod recover;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_protocol::error::{Code, Fault};
use relief_runtime::frame::{self, RenderError};
use relief_runtime::gpu::DeviceError;
use relief_runtime::planet::Planet;

use super::board::{Board, Next};
use super::drawer::Drawer;
use super::picture::{Hold, Picture, stats};
use super::recovery::Recovery;
use super::slot::{Ask, Sink};
use super::{Limits, Listener};
use crate::backend::Backend;
use crate::serve::ask::{Asked, asked, of_draw};
use recover::guarded;

/// Least time between two words on damaged tiles.
const DAMAGE_TOLD: Duration = Duration::from_secs(2);

pub(super) struct Worker {
    board: Arc<Board>,
    planet: Arc<Planet>,
    drawer: Drawer,
    limits: Limits,
    listener: Box<dyn Listener>,
    backend: Backend,
    /// Damaged tiles that were told of, and when.
    damaged: (usize, Option<Instant>),
    /// Pages that slots' last pictures lacked.
    lacked: BTreeMap<u64, Vec<u32>>,
    /// No device could be had; none is tried for before this.
    given_up: Option<(Instant, DeviceError)>,
    recovery: Recovery,
}

impl Worker {
    pub fn new(
        board: Arc<Board>,
        planet: Arc<Planet>,
        backend: Backend,
        limits: Limits,
        listener: Box<dyn Listener>,
        recovery: Recovery,
    ) -> Result<Self, RenderError> {
        let drawer = Drawer::new(&backend, &planet, limits.atlas_bytes)?;
        let (damaged, lacked) = ((0, None), BTreeMap::new());
        Ok(Self { board, planet, drawer, limits, listener, backend, damaged, lacked, given_up: None, recovery })
    }

    pub fn run(mut self) {
        // Whatever ends this thread, nobody waits for it.
        let _closing = Closing(Arc::clone(&self.board));
        loop {
            let (drawn, worked) = match self.board.next() {
                Next::Draw { slot, ask, seq, sink } => {
                    let worked = guarded(|| self.draw(slot, &ask, seq, &sink));
                    (Some((slot, ask, sink)), worked)
                }
                Next::Run(task) => (None, guarded(|| task(&mut self.drawer))),
                Next::Load => (None, guarded(|| self.load())),
                Next::Replace(planet) => (None, guarded(|| self.replace(planet))),
                Next::Stop => return,
            };
            if worked.is_err() {
                self.fell(drawn);
            }
        }
    }

    fn draw(&mut self, slot: u64, ask: &Ask, seq: u64, sink: &Sink) {
        let began = Instant::now();
        if let Some((until, error)) = &self.given_up
            && began < *until
        {
            self.board.forget(slot);
            return sink(Err(of_draw(error.clone().into()).at(ask.view)));
        }
        match self.picture(slot, ask, seq, began) {
            Ok(Some(picture)) => {
                self.listener.drew(&picture);
                self.tell_of_damage();
                sink(Ok(picture));
            }
            // Kept back until its tiles are there.
            Ok(None) => {}
            Err(Failed::Device(error)) => {
                let recovered = self.recover(&error);
                self.board.handed_over(slot);
                self.given_up = (!recovered).then(|| (Instant::now() + self.recovery.given_up, error.clone()));
                if !recovered {
                    self.board.forget(slot);
                    sink(Err(of_draw(error.into()).at(ask.view)));
                }
            }
            Err(Failed::View(fault)) => {
                self.board.forget(slot);
                sink(Err(fault.at(ask.view)));
            }
        }
    }

    fn picture(&mut self, slot: u64, ask: &Ask, seq: u64, began: Instant) -> Result<Option<Picture>, Failed> {
        let Asked { view, settings, sun_deg } = asked(&ask.what, &self.planet)?;
        let settings = frame::Settings { places: ask.places, ..settings };
        let frame = self.drawer.render(&view, &settings).map_err(|error| self.failed(error))?;
        match frame.stats.tiles_missing {
            0 => self.lacked.remove(&slot),
            _ => self.lacked.insert(slot, self.drawer.lacked()),
        };
        let mesh = match ask.mesh {
            true => Some(self.drawer.mesh(&view, settings.scheme).map_err(|error| self.failed(error))?),
            false => None,
        };
        let stats = stats(&frame.stats, ask, began);
        let complete = frame.stats.tiles_missing == 0;
        if !self.board.drawn(slot, ask.until, frame.stats.tiles_missing) {
            return Ok(None);
        }
        let hold = Arc::new(Hold { board: Arc::clone(&self.board), slot });
        let planet = Arc::clone(&self.planet);
        Ok(Some(Picture { number: ask.view, seq, planet, view, sun_deg, frame, mesh, complete, stats, hold }))
    }

    fn load(&mut self) {
        let lacking = self.board.lacking();
        self.lacked.retain(|slot, _| lacking.contains(slot));
        // Views that were not drawn since the last update want their tiles still.
        self.lacked.values().for_each(|pages| self.drawer.ask(pages));
        let progress = self.drawer.update(self.limits.time_budget);
        let left: Vec<(u64, usize)> =
            self.lacked.iter().map(|(&slot, pages)| (slot, self.drawer.still_lacks(pages))).collect();
        self.board.loaded(&progress, &left);
        self.listener.loaded(progress.resident, progress.loaded);
        self.tell_of_damage();
    }

    /// Damage is found when tiles come in, or before, when they are asked for.
    fn tell_of_damage(&mut self) {
        let (damaged, said) = self.drawer.damaged();
        let (told, when) = self.damaged;
        if damaged > told && when.is_none_or(|when| when.elapsed() >= DAMAGE_TOLD) {
            self.damaged = (damaged, Some(Instant::now()));
            self.listener.fault(Fault::new(
                Code::Damaged,
                format!("{damaged} damaged tiles, such as: {}", said.unwrap_or_default()),
                "every tile of a file is as it was published",
                "coarser tiles stand in; whoever runs the daemon copies or bakes the file again",
            ));
        }
    }

    /// What a failed drawing means: an error of one call may come from a device that is of no use any
    /// more.
    fn failed(&self, error: RenderError) -> Failed {
        match self.drawer.check() {
            Err(error) => Failed::Device(error),
            Ok(()) => Failed::from(error),
        }
    }

    fn replace(&mut self, planet: Arc<Planet>) {
        match Drawer::new(&self.backend, &planet, self.limits.atlas_bytes) {
            Ok(drawer) => {
                self.drawer = drawer;
                self.planet = planet;
                self.damaged = (0, None);
                self.lacked.clear();
                self.listener.replaced(&self.planet);
                self.board.again();
            }
            Err(error) => {
                let fault = of_draw(error);
                self.listener.fault(Fault::new(
                    fault.code,
                    format!("the replaced file cannot be shown: {}", fault.what),
                    fault.rule,
                    "the file before it is still shown; bake the new one again",
                ));
            }
        }
    }
}

/// Closes the board at its end.
struct Closing(Arc<Board>);

impl Drop for Closing {
    fn drop(&mut self) {
        self.0.close();
    }
}

/// Why no picture came about.
enum Failed {
    /// The viewer's part, or the device's refusal of this one view.
    View(Fault),
    /// The device is of no use any more.
    Device(DeviceError),
}

impl From<Fault> for Failed {
    fn from(fault: Fault) -> Self {
        Self::View(fault)
    }
}

impl From<RenderError> for Failed {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Device(
                error @ (DeviceError::Lost(_) | DeviceError::NoAdapter(_) | DeviceError::NoDevice { .. }),
            ) => Self::Device(error),
            error => Self::View(of_draw(error)),
        }
    }
}
