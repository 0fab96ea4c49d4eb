//! Figures for the operator, as `/metrics` and `/healthz` show them.

mod process;
mod recent;
mod register;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::gauge::Gauge;
use relief_protocol::error::Code;
use relief_protocol::payload::Stats;
use utoipa::ToSchema;

use recent::Recent;
use register::{Figures, OfCode, OfPlanet, OfQuantile, OfRequest, OfRoute};

/// Quantiles of the times of recent frames.
const QUANTILES: [f64; 3] = [0.5, 0.95, 0.99];

/// Counts since the daemon started.
#[derive(Default)]
pub struct Meters {
    figures: Figures,
    planets: Mutex<BTreeMap<String, OnePlanet>>,
}

/// What is kept of a planet beside its figures.
#[derive(Default)]
struct OnePlanet {
    frames: Recent,
    trouble: Trouble,
}

/// What viewers of a planet see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Trouble {
    /// All that was asked for.
    #[default]
    Good,
    /// Coarser tiles where some are damaged.
    Damaged,
    /// Nothing new until the GPU is back.
    Device,
}

/// What is counted when it is asked for.
pub struct Census {
    /// The planet.
    pub planet: String,
    /// Cameras and tasks of its engine.
    pub cameras: usize,
    /// Hits and misses of its decoded tiles.
    pub cache: [u64; 2],
}

/// A request that is in work.
pub struct AtWork(Gauge);

impl Drop for AtWork {
    fn drop(&mut self) {
        self.0.dec();
    }
}

impl Meters {
    /// Viewers came or went.
    pub fn viewers(&self, change: i64) {
        self.figures.viewers.inc_by(change);
    }

    /// A picture was drawn.
    pub fn drew(&self, planet: &str, stats: &Stats) {
        tracing::trace!(planet, triangles = stats.triangles, draw_ms = stats.draw_ms, "drew");
        let of = OfPlanet::new(planet);
        self.figures.frames.get_or_create(&of).inc();
        self.figures.frame_seconds.get_or_create(&of).observe(stats.draw_ms / 1e3);
        self.figures.triangles.get_or_create(&of).set(stats.triangles as i64);
        self.figures.tiles_resident.get_or_create(&of).set(stats.tiles_resident as i64);
        self.of(planet, |one| {
            one.frames.add(Instant::now(), stats.draw_ms / 1e3);
            if one.trouble == Trouble::Device {
                one.trouble = Trouble::Good;
            }
        });
    }

    /// Tiles came in.
    pub fn loaded(&self, planet: &str, resident: usize, loaded: usize) {
        tracing::trace!(planet, resident, loaded, "loaded");
        let of = OfPlanet::new(planet);
        self.figures.tiles_resident.get_or_create(&of).set(resident as i64);
        self.figures.tiles_loaded.get_or_create(&of).inc_by(loaded as u64);
    }

    /// A picture was packed into so many bytes, which are on their way.
    pub fn packed(&self, took: Duration, bytes: u64) {
        self.figures.pack_seconds.observe(took.as_secs_f64());
        self.figures.payload_bytes.inc_by(bytes);
    }

    /// An HTTP request is in work until what is returned is dropped.
    pub fn at_work(&self) -> AtWork {
        self.figures.requests_in_work.inc();
        AtWork(self.figures.requests_in_work.clone())
    }

    /// An HTTP request was answered.
    pub fn answered(&self, route: &str, status: u16, took: Duration, bytes: u64) {
        let route = route.to_owned();
        self.figures.request_seconds.get_or_create(&OfRoute { route: route.clone() }).observe(took.as_secs_f64());
        self.figures.requests.get_or_create(&OfRequest { route, status }).inc();
        self.figures.http_bytes.inc_by(bytes);
    }

    /// A viewer or an asker was told that something is wrong.
    pub fn fault(&self, code: Code) {
        tracing::trace!(?code, "fault");
        self.figures.faults.get_or_create(&OfCode::new(code)).inc();
    }

    /// All viewers of a planet were told that something is wrong.
    pub fn planet_fault(&self, planet: &str, code: Code) {
        self.fault(code);
        self.of(planet, |one| match code {
            Code::Damaged => one.trouble = Trouble::Damaged,
            Code::Device => one.trouble = Trouble::Device,
            _ => {}
        });
    }

    /// A planet's file was replaced: the new one has no trouble yet.
    pub fn replaced(&self, planet: &str) {
        self.of(planet, |one| one.trouble = Trouble::Good);
    }

    /// What viewers of a planet see.
    pub fn trouble(&self, planet: &str) -> Trouble {
        self.of(planet, |one| one.trouble)
    }

    /// All figures as OpenMetrics text.
    pub fn text(&self, census: impl Iterator<Item = Census>) -> String {
        let figures = &self.figures;
        for Census { planet, cameras, cache: [hits, misses] } in census {
            let of = OfPlanet::new(&planet);
            figures.cameras.get_or_create(&of).set(cameras as i64);
            figures.cache_hits.get_or_create(&of).inner().store(hits, std::sync::atomic::Ordering::Relaxed);
            figures.cache_misses.get_or_create(&of).inner().store(misses, std::sync::atomic::Ordering::Relaxed);
            let seconds = self.of(&planet, |one| one.frames.quantiles(Instant::now(), QUANTILES));
            for (quantile, seconds) in QUANTILES.iter().zip(seconds) {
                let of = OfQuantile { planet: planet.clone(), quantile: quantile.to_string() };
                figures.recent_seconds.get_or_create(&of).set(seconds);
            }
        }
        if let Some(bytes) = process::resident_bytes() {
            figures.resident_bytes.set(bytes as i64);
        }
        let mut text = String::new();
        // Writing to a String cannot fail.
        if encode(&mut text, figures.registry()).is_err() {
            let _ = write!(text, "# EOF");
        }
        text
    }

    fn of<T>(&self, planet: &str, change: impl FnOnce(&mut OnePlanet) -> T) -> T {
        // A panic elsewhere leaves figures as they were.
        let mut planets: MutexGuard<'_, _> = self.planets.lock().unwrap_or_else(PoisonError::into_inner);
        if !planets.contains_key(planet) {
            planets.insert(planet.to_owned(), OnePlanet::default());
        }
        change(planets.entry(planet.to_owned()).or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn census() -> Census {
        Census { planet: "earth".into(), cameras: 2, cache: [30, 10] }
    }

    #[test]
    fn figures_are_text() {
        let meters = Meters::default();
        for ms in [10.0, 20.0, 30.0] {
            meters.drew("earth", &Stats { draw_ms: ms, triangles: 77, tiles_resident: 5, ..Stats::default() });
        }
        meters.viewers(3);
        meters.viewers(-1);
        meters.fault(Code::BadView);
        meters.answered("/v1/planets", 200, Duration::from_millis(3), 120);
        meters.packed(Duration::from_millis(2), 1000);
        meters.loaded("earth", 6, 4);
        let _one = meters.at_work();
        drop(meters.at_work());
        let text = meters.text([census()].into_iter());
        for line in [
            "relief_frames_total{planet=\"earth\"} 3",
            "relief_frame_seconds_count{planet=\"earth\"} 3",
            "relief_frame_recent_seconds{planet=\"earth\",quantile=\"0.5\"} 0.02",
            "relief_frame_recent_seconds{planet=\"earth\",quantile=\"0.99\"} 0.03",
            "relief_triangles{planet=\"earth\"} 77",
            "relief_tiles_resident{planet=\"earth\"} 6",
            "relief_tiles_loaded_total{planet=\"earth\"} 4",
            "relief_tile_cache_hits_total{planet=\"earth\"} 30",
            "relief_tile_cache_misses_total{planet=\"earth\"} 10",
            "relief_cameras{planet=\"earth\"} 2",
            "relief_viewers 2",
            "relief_faults_total{code=\"bad_view\"} 1",
            "relief_http_requests_total{route=\"/v1/planets\",status=\"200\"} 1",
            "relief_http_requests_in_work 1",
            "relief_http_bytes_total 120",
            "relief_payload_bytes_total 1000",
            "# EOF",
        ] {
            assert!(text.lines().any(|found| found == line), "{line} is not in:\n{text}");
        }
    }

    #[test]
    fn troubles_come_and_go() {
        let meters = Meters::default();
        assert_eq!(meters.trouble("earth"), Trouble::Good);
        meters.planet_fault("earth", Code::Device);
        assert_eq!((meters.trouble("earth"), meters.trouble("moon")), (Trouble::Device, Trouble::Good));
        meters.drew("earth", &Stats::default());
        assert_eq!(meters.trouble("earth"), Trouble::Good);
        meters.planet_fault("earth", Code::Damaged);
        meters.drew("earth", &Stats::default());
        assert_eq!(meters.trouble("earth"), Trouble::Damaged);
        meters.replaced("earth");
        assert_eq!(meters.trouble("earth"), Trouble::Good);
    }
}
