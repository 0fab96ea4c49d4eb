//! SIGTERM and Ctrl-C: viewers are told, what is in flight ends, nothing new begins.

use relief_client::{AttachError, Attached, Options};

use crate::daemon::{Daemon, Files, PATIENCE, poll};

/// Takes a good part of a second on two cores.
const SLOW: &str = "/v1/planets/globe/render?camera=20,10,9000000&size=1200x1200&sun=60,10&soft=1&pixel_error=0.3";

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
    std::thread::scope(|scope| {
        let slow = scope.spawn(|| daemon.get(SLOW));
        poll("the engine's work", || (daemon.get("/healthz").json(200)["planets"][0]["cameras"] == 1).then_some(()));
        daemon.signal("TERM");
        let health = poll("the end", || Some(daemon.get("/healthz")).filter(|answer| answer.status == 503));
        assert_eq!(health.json(503)["status"], "stopping");
        let refused = daemon.get("/v1/planets");
        assert_eq!(refused.header("retry-after"), Some("1"));
        assert_eq!(refused.json(503)["code"], "busy");
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
    std::thread::scope(|scope| {
        let slow = scope.spawn(|| daemon.get(SLOW));
        let refused = poll("a refusal", || {
            let answer = daemon.get("/v1/planets/globe/height?lon=1&lat=1");
            (answer.status == 503).then_some(answer)
        });
        assert_eq!(refused.header("retry-after"), Some("1"));
        assert_eq!(refused.json(503)["code"], "busy");
        // What is no work is answered all the same.
        daemon.get("/v1/planets").good();
        slow.join().unwrap().good();
    });
    daemon.get("/v1/planets/globe/height?lon=1&lat=1").good();
}
