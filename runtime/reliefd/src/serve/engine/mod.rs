//! The engine of a planet: a thread with the one renderer and its tiles, shared by all cameras of
//! all viewers. It draws; packing and sending happen elsewhere.

mod board;
mod drawer;
mod picture;
mod recovery;
mod slot;
mod work;

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use relief_protocol::error::{Code, Fault};
use relief_protocol::view::View;
use relief_runtime::frame::RenderError;
use relief_runtime::planet::Planet;
use tokio::sync::oneshot;

use crate::backend::{Backend, BackendChoice};
use board::Board;
use recovery::Recovery;
use work::Worker;

pub use drawer::Drawer;
pub use picture::{Hold, Picture};
pub use slot::{Ask, Sink};

/// What an engine may use.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Where it draws.
    pub backend: BackendChoice,
    /// Bytes of tiles in the atlas.
    pub atlas_bytes: u64,
    /// Time for loading tiles between two rounds of drawing.
    pub time_budget: Duration,
}

/// One picture that is asked for.
pub struct Once {
    /// What is looked at.
    pub what: View,
    /// Also the triangles.
    pub mesh: bool,
    /// Also the places that pixels show.
    pub places: bool,
    /// Longest time to wait for tiles.
    pub wait: Duration,
}

/// Hears of what happens to a planet while it is served.
pub trait Listener: Send + 'static {
    /// A picture was drawn.
    fn drew(&self, picture: &Picture);
    /// Tiles came in, or not.
    fn loaded(&self, resident: usize, loaded: usize);
    /// The file was replaced, and this is its planet.
    fn replaced(&self, planet: &Arc<Planet>);
    /// Something is wrong that concerns all who look at this planet.
    fn fault(&self, fault: Fault);
}

/// An engine that cannot start: whoever runs the daemon acts.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The backend, or the file's coarsest tiles.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The operating system.
    #[error("cannot start a thread: {0}")]
    Thread(std::io::Error),
}

/// An engine; dropping it ends its thread.
pub struct Engine {
    board: Arc<Board>,
    thread: Option<JoinHandle<()>>,
    backend: String,
}

impl Engine {
    /// Starts drawing a planet.
    ///
    /// # Errors
    /// A backend that is not there, or a planet whose coarsest tiles are damaged.
    pub fn start(
        planet: Arc<Planet>,
        backend: Backend,
        limits: Limits,
        listener: impl Listener,
    ) -> Result<Self, StartError> {
        Self::start_with(planet, backend, limits, listener, Recovery::default())
    }

    fn start_with(
        planet: Arc<Planet>,
        backend: Backend,
        limits: Limits,
        listener: impl Listener,
        recovery: Recovery,
    ) -> Result<Self, StartError> {
        let board = Arc::new(Board::default());
        let name = backend.name();
        let worker = Worker::new(Arc::clone(&board), planet, backend, limits, Box::new(listener), recovery)?;
        let thread = std::thread::Builder::new()
            .name("engine".into())
            .spawn(move || worker.run())
            .map_err(StartError::Thread)?;
        Ok(Self { board, thread: Some(thread), backend: name })
    }

    /// What draws: adapter and driver, or the CPU.
    pub fn backend(&self) -> &str {
        &self.backend
    }

    /// A camera whose pictures go to `sink`.
    pub fn camera(self: &Arc<Self>, client: u64, sink: Sink) -> Camera {
        Camera { engine: Arc::clone(self), slot: self.board.add(client, sink) }
    }

    /// One picture, once nothing is missing or after `wait`.
    ///
    /// # Errors
    /// A view that shows nothing, or a daemon that ends.
    pub async fn draw_once(self: &Arc<Self>, client: u64, once: Once) -> Result<Picture, Fault> {
        let (sender, receiver) = oneshot::channel();
        let sender = std::sync::Mutex::new(Some(sender));
        let sink: Sink = Arc::new(move |result| {
            let taken = sender.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take();
            if let Some(sender) = taken {
                // The asker may be gone.
                let _ = sender.send(result);
            }
        });
        let camera = self.camera(client, sink);
        let arrived = Instant::now();
        let Once { what, mesh, places, wait } = once;
        camera.ask(Ask { view: 0, what: Arc::new(what), mesh, places, arrived, until: Some(arrived + wait) });
        receiver.await.unwrap_or_else(|_| Err(ending()))
    }

    /// Does something on the engine's thread, in its client's turn.
    ///
    /// # Errors
    /// A daemon that ends.
    pub async fn run<T: Send + 'static>(
        &self,
        client: u64,
        task: impl FnOnce(&mut Drawer) -> T + Send + 'static,
    ) -> Result<T, Fault> {
        let (sender, receiver) = oneshot::channel();
        self.board.run(
            client,
            Box::new(move |drawer| {
                // The asker may be gone.
                let _ = sender.send(task(drawer));
            }),
        );
        receiver.await.map_err(|_| ending())
    }

    /// The planet's file was replaced.
    pub fn replace(&self, planet: Arc<Planet>) {
        self.board.replace(planet);
    }

    /// Cameras and tasks that are there.
    pub fn load(&self) -> usize {
        self.board.len()
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.board.stop();
        if let Some(thread) = self.thread.take() {
            // A panic there was said on standard error already.
            let _ = thread.join();
        }
    }
}

/// A camera; dropping it ends it.
pub struct Camera {
    engine: Arc<Engine>,
    slot: u64,
}

impl Camera {
    /// What it looks at from now on.
    pub fn ask(&self, ask: Ask) {
        self.engine.board.ask(self.slot, ask);
    }

    /// Pictures up to this number have arrived.
    pub fn acknowledge(&self, seq: u64) {
        self.engine.board.acknowledge(self.slot, seq);
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        self.engine.board.remove(self.slot);
    }
}

fn ending() -> Fault {
    Fault::new(Code::Internal, "the daemon is ending", "a picture needs a daemon that runs", "attach again later")
}

#[cfg(test)]
mod tests;
