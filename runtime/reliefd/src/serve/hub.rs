//! What all viewers share: the planets, the seats, the token, the figures.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock, PoisonError, RwLock};

use relief_formats::body::Body;
use relief_protocol::error::{Code, Fault};
use relief_protocol::to_viewer::{self, ToViewer};
use relief_runtime::planet::Planet;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, broadcast};

use super::engine::{Engine, Listener, Picture};
use super::meters::Meters;

/// News that a slow viewer may be behind.
const NEWS: usize = 64;

/// Everything that is served.
pub struct Hub {
    served: BTreeMap<String, Arc<Served>>,
    seats: Arc<Semaphore>,
    most_viewers: usize,
    clients: AtomicU64,
    token: Option<blake3::Hash>,
    news: broadcast::Sender<ToViewer>,
    /// Figures for the operator.
    pub meters: Arc<Meters>,
}

/// A planet that is served.
pub struct Served {
    /// The file's stem.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// What draws it.
    pub engine: Arc<Engine>,
    planet: Arc<RwLock<Arc<Planet>>>,
}

/// A viewer's place among those who are attached; dropping it frees it.
pub struct Seat {
    viewer: u64,
    _permit: OwnedSemaphorePermit,
    meters: Arc<Meters>,
}

impl Seat {
    /// The daemon's number for the viewer.
    pub fn viewer(&self) -> u64 {
        self.viewer
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.meters.viewers(-1);
    }
}

impl Hub {
    /// No planets yet.
    pub fn new(most_viewers: usize, token: Option<&str>, meters: Arc<Meters>) -> Self {
        Self {
            served: BTreeMap::new(),
            seats: Arc::new(Semaphore::new(most_viewers)),
            most_viewers,
            clients: AtomicU64::new(1),
            token: token.map(|token| blake3::hash(token.as_bytes())),
            news: broadcast::channel(NEWS).0,
            meters,
        }
    }

    /// Serves a planet.
    pub fn add(&mut self, served: Served) {
        self.served.insert(served.name.clone(), Arc::new(served));
    }

    /// A seat for a viewer.
    ///
    /// # Errors
    /// [`Code::Busy`].
    pub fn seat(&self) -> Result<Seat, Fault> {
        match Arc::clone(&self.seats).try_acquire_owned() {
            Ok(permit) => {
                self.meters.viewers(1);
                let viewer = self.client();
                Ok(Seat { viewer, _permit: permit, meters: Arc::clone(&self.meters) })
            }
            Err(_) => Err(Fault::new(
                Code::Busy,
                format!("{} viewers are attached", self.most_viewers),
                "a daemon takes as many viewers as --max-viewers allows",
                "attach again later, or ask whoever runs the daemon for more",
            )
            .fatal()),
        }
    }

    /// A number for someone who takes turns with others at the engines.
    pub fn client(&self) -> u64 {
        self.clients.fetch_add(1, Ordering::Relaxed)
    }

    /// Whether this daemon has a token.
    pub fn has_token(&self) -> bool {
        self.token.is_some()
    }

    /// Waits until no viewer is attached.
    pub async fn emptied(&self) {
        // It is never closed.
        let _ = self.seats.acquire_many(u32::try_from(self.most_viewers).unwrap_or(u32::MAX)).await;
    }

    /// Whether a token opens this daemon. Hashes are compared in constant time.
    pub fn admits(&self, token: Option<&str>) -> bool {
        self.token.is_none_or(|hash| token.is_some_and(|token| blake3::hash(token.as_bytes()) == hash))
    }

    /// What someone without the right token is told.
    pub fn no_token(&self, given: bool) -> Fault {
        let what = if given { "a token that is not the daemon's" } else { "no token" };
        let remedy = "send `Authorization: Bearer TOKEN`, or ?token=TOKEN; whoever runs the daemon has it";
        Fault::new(Code::Token, what, "this daemon has a token, and whoever uses it shows it", remedy)
    }

    /// A planet by its name.
    ///
    /// # Errors
    /// [`Code::Unknown`].
    pub fn served(&self, name: &str) -> Result<Arc<Served>, Fault> {
        self.served.get(name).map(Arc::clone).ok_or_else(|| {
            let names: Vec<&str> = self.served.keys().map(String::as_str).collect();
            Fault::new(
                Code::Unknown,
                format!("the planet {name:?}"),
                format!("this daemon serves {}", names.join(", ")),
                "name one of these",
            )
        })
    }

    /// All that is served.
    pub fn all(&self) -> impl Iterator<Item = &Arc<Served>> {
        self.served.values()
    }

    /// All planets in words.
    pub fn planets(&self) -> Vec<to_viewer::Planet> {
        self.served.values().map(|served| served.described()).collect()
    }

    /// What happens from now on that concerns all viewers.
    pub fn news(&self) -> broadcast::Receiver<ToViewer> {
        self.news.subscribe()
    }

    /// Tells all viewers.
    pub fn tell(&self, message: ToViewer) {
        // Nobody may be attached.
        let _ = self.news.send(message);
    }

    /// What hears of a planet's engine.
    pub fn ear(&self, name: &str, planet: &Arc<Planet>) -> Ear {
        Ear {
            name: name.to_owned(),
            planet: Arc::new(RwLock::new(Arc::clone(planet))),
            backend: Arc::default(),
            news: self.news.clone(),
            meters: Arc::clone(&self.meters),
        }
    }
}

impl Served {
    /// A planet whose engine talks to an ear.
    pub fn new(ear: &Ear, path: PathBuf, engine: Arc<Engine>) -> Self {
        // Set once, before anybody asks.
        let _ = ear.backend.set(engine.backend().to_owned());
        Self { name: ear.name.clone(), path, planet: Arc::clone(&ear.planet), engine }
    }

    /// The planet as it is now.
    pub fn planet(&self) -> Arc<Planet> {
        Arc::clone(&self.planet.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// In words.
    pub fn described(&self) -> to_viewer::Planet {
        described(&self.name, &self.planet(), self.engine.backend())
    }
}

/// Hears of a planet's engine, and tells viewers and meters.
#[derive(Clone)]
pub struct Ear {
    name: String,
    planet: Arc<RwLock<Arc<Planet>>>,
    backend: Arc<OnceLock<String>>,
    news: broadcast::Sender<ToViewer>,
    meters: Arc<Meters>,
}

impl Listener for Ear {
    fn drew(&self, picture: &Picture) {
        self.meters.drew(&self.name, &picture.stats);
    }

    fn loaded(&self, resident: usize, loaded: usize) {
        self.meters.loaded(&self.name, resident, loaded);
    }

    fn replaced(&self, planet: &Arc<Planet>) {
        *self.planet.write().unwrap_or_else(PoisonError::into_inner) = Arc::clone(planet);
        self.meters.replaced(&self.name);
        tracing::info!(planet = self.name, "the file was replaced; cameras are drawn anew");
        let backend = self.backend.get().map_or("", String::as_str);
        // Nobody may be attached.
        let _ = self.news.send(ToViewer::Planet(described(&self.name, planet, backend)));
    }

    fn fault(&self, fault: Fault) {
        // All viewers hear of it, those who look at other planets too.
        let fault = Fault { what: format!("{}: {}", self.name, fault.what), ..fault };
        tracing::warn!(planet = self.name, code = ?fault.code, "{}", fault.what);
        self.meters.planet_fault(&self.name, fault.code);
        let _ = self.news.send(ToViewer::Error(fault));
    }
}

fn described(name: &str, planet: &Planet, backend: &str) -> to_viewer::Planet {
    let relief = planet.relief();
    let header = relief.header();
    let (body, a_m, b_m) = match relief.body() {
        Body::Plane { .. } => ("plane".to_owned(), None, None),
        Body::Ellipsoid { name, a_m, b_m } => (name.clone(), Some(*a_m), Some(*b_m)),
    };
    let [west, south] = planet.place_of([0, 0]);
    let [east, north] = match relief.body() {
        Body::Plane { .. } => planet.place_of([1 << 31, 1 << 31]),
        Body::Ellipsoid { .. } => [180.0, 90.0],
    };
    to_viewer::Planet {
        name: name.to_owned(),
        body,
        plane: planet.grid().plane,
        a_m,
        b_m,
        bounds: [west, south, east, north],
        metres_per_unit: planet.metres_per_unit(),
        has_time: crate::light::has_time(planet),
        m: header.m,
        spacing_m: planet.spacing_m(),
        min_m: f64::from(header.min_q) * relief.step_m(),
        max_m: f64::from(header.max_q) * relief.step_m(),
        content_id: header.content_id.iter().map(|byte| format!("{byte:02x}")).collect(),
        backend: backend.to_owned(),
    }
}
