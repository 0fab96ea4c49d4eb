//! SIGTERM and Ctrl-C: viewers are told, what is in flight ends, nothing new begins.

use relief_client::{AttachError, Attached, Options};

use crate::client::begin_post;
use crate::daemon::{Daemon, Files, PATIENCE, poll};
use crate::figures::figure;

/// Takes a good part of a second on two cores.
const SLOW: &str = "/v1/planets/globe/render?camera=20,10,9000000&size=1200x1200&sun=60,10&soft=1&pixel_error=0.3";

const HEIGHTS: &str = "/v1/planets/globe/heights";
const POINTS: &str = "{\"points\":[[1,2],[3,4]]}";

fn in_work(daemon: &Daemon) -> f64 {
    let metrics = daemon.get("/metrics").good().text();
    figure(&metrics, "relief_http_requests_in_work").unwrap()
}

#[test]
fn an_idle_daemon_ends_at_once() {
    let files = Files::new();
    for signal in ["TERM", "INT"] {
        let daemon = Daemon::start(&files, "");
        daemon.get("/healthz").good();
        daemon.signal(signal);
        let began = std::time::Instant::now();
        let (code, log) = daemon.ended();
        assert_eq!(code, 0, "{log}");
        assert!(began.elapsed().as_secs() < 8, "it waited for nothing: {log}");
    }
}

#[test]
fn what_is_in_flight_ends_and_nothing_new_begins() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let cameras = || daemon.get("/healthz").json(200)["planets"][0]["cameras"] == 1;
    std::thread::scope(|scope| {
        let slow = poll("a picture on its way", || {
            let slow = scope.spawn(|| daemon.get(SLOW));
            // On a fast machine it may be done before anybody looks.
            let seen = poll("the engine's work", || (cameras() || slow.is_finished()).then_some(!slow.is_finished()));
            seen.then_some(slow)
        });
        let points = begin_post(daemon.address(), HEIGHTS, POINTS);
        poll("their place", || {
            let others = if slow.is_finished() { 0.0 } else { 1.0 };
            (in_work(&daemon) > others).then_some(())
        });
        daemon.signal("TERM");
        let health = poll("the end", || Some(daemon.get("/healthz")).filter(|answer| answer.status == 503));
        assert_eq!(health.json(503)["status"], "stopping");
        let refused = daemon.get("/v1/planets");
        assert_eq!(refused.header("retry-after"), Some("1"));
        assert_eq!(refused.json(503)["code"], "busy");
        points.finish().good();
        assert!(slow.join().unwrap().good().body.len() > 100_000);
    });
    assert_eq!(daemon.ended().0, 0);
}

#[test]
fn viewers_are_told() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "--unix DIR/socket");
    let socket = files.path("socket").display().to_string();
    let mut viewers = [daemon.address(), &socket].map(|at| Attached::to(at, &Options::default()).unwrap());
    daemon.signal("TERM");
    for viewer in &mut viewers {
        let told = viewer.next_within(PATIENCE).unwrap_err();
        assert!(matches!(&told, AttachError::Bye(reason) if reason.contains("ending")), "{told:?}");
    }
    assert_eq!(daemon.ended().0, 0);
    assert!(!files.path("socket").exists());
}

#[test]
fn more_work_than_there_is_room_for_is_refused() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "--max-requests 1");
    let first = begin_post(daemon.address(), HEIGHTS, POINTS);
    poll("its place", || (in_work(&daemon) == 1.0).then_some(()));
    let refused = daemon.get("/v1/planets/globe/height?lon=1&lat=1");
    assert_eq!(refused.header("retry-after"), Some("1"));
    assert_eq!(refused.json(503)["code"], "busy");
    // What is no work is answered all the same.
    daemon.get("/v1/planets").good();
    first.finish().good();
    daemon.get("/v1/planets/globe/height?lon=1&lat=1").good();
}
