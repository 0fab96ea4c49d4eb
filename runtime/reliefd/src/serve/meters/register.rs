//! The figures by their names.

use std::sync::atomic::AtomicU64;

use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Metric, Registry, Unit};
use relief_protocol::error::Code;

/// Bounds of the histograms' buckets, seconds.
const SECONDS: [f64; 15] =
    [0.001, 0.002, 0.004, 0.008, 0.016, 0.033, 0.066, 0.125, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0];

type Histograms<L> = Family<L, Histogram, fn() -> Histogram>;
type FloatGauge = Gauge<f64, AtomicU64>;

/// Of a planet.
#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
pub struct OfPlanet {
    planet: String,
}

impl OfPlanet {
    /// By its name.
    pub fn new(planet: &str) -> Self {
        Self { planet: planet.to_owned() }
    }
}

/// A quantile of a planet's frames.
#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
pub struct OfQuantile {
    /// The planet.
    pub planet: String,
    /// 0 to 1.
    pub quantile: String,
}

/// Of a kind of fault.
#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
pub struct OfCode {
    code: String,
}

impl OfCode {
    /// By the word that viewers get.
    pub fn new(code: Code) -> Self {
        let word = serde_json::to_value(code).ok();
        Self { code: word.as_ref().and_then(|word| word.as_str()).unwrap_or("other").to_owned() }
    }
}

/// Of an HTTP route.
#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
pub struct OfRoute {
    /// As OpenAPI has it; `none` for paths that are none.
    pub route: String,
}

/// Of HTTP requests with one outcome.
#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
pub struct OfRequest {
    /// As OpenAPI has it; `none` for paths that are none.
    pub route: String,
    /// The answer's status.
    pub status: u16,
}

/// All figures.
pub struct Figures {
    registry: Registry,
    pub viewers: Gauge,
    pub cameras: Family<OfPlanet, Gauge>,
    pub frames: Family<OfPlanet, Counter>,
    pub frame_seconds: Histograms<OfPlanet>,
    pub recent_seconds: Family<OfQuantile, FloatGauge>,
    pub triangles: Family<OfPlanet, Gauge>,
    pub tiles_resident: Family<OfPlanet, Gauge>,
    pub tiles_loaded: Family<OfPlanet, Counter>,
    pub cache_hits: Family<OfPlanet, Counter>,
    pub cache_misses: Family<OfPlanet, Counter>,
    pub faults: Family<OfCode, Counter>,
    pub pack_seconds: Histogram,
    pub payload_bytes: Counter,
    pub requests_in_work: Gauge,
    pub requests: Family<OfRequest, Counter>,
    pub request_seconds: Histograms<OfRoute>,
    pub http_bytes: Counter,
    pub resident_bytes: Gauge,
}

impl Figures {
    /// What is encoded.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }
}

impl Default for Figures {
    fn default() -> Self {
        let mut all = Registry::default();
        let relief = all.sub_registry_with_prefix("relief");
        let seconds: fn() -> Histogram = || Histogram::new(SECONDS);
        let figures = Self {
            viewers: put(relief, "viewers", "Viewers that are attached"),
            cameras: put(relief, "cameras", "Cameras and tasks of a planet's engine"),
            frames: put(relief, "frames", "Pictures drawn"),
            frame_seconds: timed(relief, "frame", "Time to draw a picture", Family::new_with_constructor(seconds)),
            recent_seconds: timed(
                relief,
                "frame_recent",
                "Quantiles of the time to draw a picture over the last five minutes",
                Family::default(),
            ),
            triangles: put(relief, "triangles", "Triangles of the last picture"),
            tiles_resident: put(relief, "tiles_resident", "Tiles in the atlas"),
            tiles_loaded: put(relief, "tiles_loaded", "Tiles that came into the atlas"),
            cache_hits: put(relief, "tile_cache_hits", "Decoded planes of tiles that were at hand"),
            cache_misses: put(relief, "tile_cache_misses", "Decoded planes of tiles that had to be decoded"),
            faults: put(relief, "faults", "Faults that viewers and askers were told, by code"),
            pack_seconds: timed(relief, "pack", "Time to pack a picture for a viewer", seconds()),
            payload_bytes: put(relief, "payload_bytes", "Bytes of pictures for viewers"),
            requests_in_work: put(relief, "http_requests_in_work", "HTTP requests in work, of --max-requests"),
            requests: put(relief, "http_requests", "HTTP requests, by route and status"),
            request_seconds: timed(
                relief,
                "http_request",
                "Time to answer an HTTP request",
                Family::new_with_constructor(seconds),
            ),
            http_bytes: put(relief, "http_bytes", "Bytes of HTTP answers"),
            resident_bytes: put(relief, "resident_memory_bytes", "RAM that the process holds"),
            registry: Registry::default(),
        };
        Self { registry: all, ..figures }
    }
}

fn put<M: Metric + Clone + Default>(registry: &mut Registry, name: &str, help: &str) -> M {
    let metric = M::default();
    registry.register(name, help, metric.clone());
    metric
}

fn timed<M: Metric + Clone>(registry: &mut Registry, name: &str, help: &str, metric: M) -> M {
    registry.register_with_unit(name, help, Unit::Seconds, metric.clone());
    metric
}
