//! /healthz and /metrics.

use relief_client::{Attached, Event, Options};
use relief_formats::file::{Plane, Relief};
use relief_formats::tile::TileKey;
use relief_protocol::to_server::{Frame, Streams};
use relief_protocol::view::View;

use crate::daemon::{Daemon, Files, PATIENCE, poll};

/// The value of a figure with its labels.
pub fn figure(text: &str, name: &str) -> Option<f64> {
    text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')?.parse().ok())
}

#[test]
fn figures_count_what_happens() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let metrics = || daemon.get("/metrics").good();
    assert!(metrics().header("content-type").unwrap().starts_with("application/openmetrics-text"));
    for _ in 0..3 {
        daemon.get("/v1/planets/globe/render?camera=20,10,300000&size=64x36").good();
    }
    daemon.get("/v1/planets/globe/render?camera=1");
    let mut viewer = Attached::to(daemon.address(), &Options::default()).unwrap();
    viewer.camera("main", "globe", Streams { frame: Some(Frame::default()), ..Streams::default() }).unwrap();
    viewer.view("main", View::down([20.0, 10.0, 3e5], [64, 36])).unwrap();
    let payload = viewer.next_within(PATIENCE).unwrap().unwrap();
    assert!(matches!(payload, Event::Payload(_)), "{payload:?}");
    let text = poll("the viewer's picture", || {
        let text = metrics().text();
        (figure(&text, "relief_payload_bytes_total") > Some(0.0)).then_some(text)
    });
    let at_least = |name: &str, least: f64| {
        let found = figure(&text, name);
        assert!(found >= Some(least), "{name} is {found:?} in\n{text}");
    };
    at_least("relief_frames_total{planet=\"globe\"}", 4.0);
    at_least("relief_frame_seconds_count{planet=\"globe\"}", 4.0);
    at_least("relief_frame_recent_seconds{planet=\"globe\",quantile=\"0.99\"}", 1e-6);
    at_least("relief_triangles{planet=\"globe\"}", 1.0);
    at_least("relief_tiles_resident{planet=\"globe\"}", 1.0);
    at_least("relief_tiles_loaded_total{planet=\"globe\"}", 1.0);
    at_least("relief_tile_cache_misses_total{planet=\"globe\"}", 1.0);
    at_least("relief_cameras{planet=\"globe\"}", 1.0);
    at_least("relief_viewers", 1.0);
    at_least("relief_faults_total{code=\"malformed\"}", 1.0);
    at_least("relief_pack_seconds_count", 1.0);
    at_least("relief_http_requests_total{route=\"/v1/planets/{name}/render\",status=\"200\"}", 3.0);
    at_least("relief_http_requests_total{route=\"/v1/planets/{name}/render\",status=\"400\"}", 1.0);
    at_least("relief_http_request_seconds_count{route=\"/v1/planets/{name}/render\"}", 4.0);
    at_least("relief_http_bytes_total", 1000.0);
    at_least("relief_resident_memory_bytes", 1e6);
    assert!(text.ends_with("# EOF\n"));
    drop(viewer);
    poll("the viewer's end", || (figure(&metrics().text(), "relief_viewers") == Some(0.0)).then_some(()));
}

#[test]
fn damage_shows_in_the_health() {
    let files = Files::new();
    let mut bytes = std::fs::read(files.path("globe.relief")).unwrap();
    let at = {
        let relief = Relief::open(&files.path("globe.relief")).unwrap();
        let entry = relief.find(TileKey::new(0, 2, 1)).unwrap().unwrap();
        relief.plane_bytes(&entry, Plane::Nodes).as_ptr().addr() - relief.bytes().as_ptr().addr()
    };
    bytes[at..at + 256].fill(0x5a);
    std::fs::write(files.path("bad.relief"), bytes).unwrap();
    let words = "serve DIR/bad.relief DIR/globe.relief --backend cpu --listen auto --headless";
    let daemon = Daemon::spawn(files.command(words));
    let state = |at: usize| daemon.get("/healthz").json(200)["planets"][at]["state"].clone();
    assert_eq!((state(0), state(1)), ("good".into(), "good".into()));
    let tile = "lon=20&lat=20";
    assert_eq!(daemon.get(&format!("/v1/planets/bad/height?{tile}")).json(500)["code"], "damaged");
    let picture = daemon.get("/v1/planets/bad/render?camera=20,20,100000&size=64x64&wait=30").good();
    assert_eq!(picture.header("x-relief-complete"), Some("true"), "a coarser tile stands in: {picture:?}");
    poll("the damage", || (state(0) == "damaged").then_some(()));
    assert_eq!(state(1), "good");
    daemon.get("/v1/planets/bad/height?lon=-100&lat=20").good();
}
