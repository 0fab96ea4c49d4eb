//! Viewers that do not read, or acknowledge nothing.

use std::time::{Duration, Instant};

use relief_tests::folder::Folder;

use crate::daemon::Daemon;
use crate::raw::{CAMERA, Raw};
use crate::viewer::{Viewer, down};

/// A picture of 1 MB, so that a socket's buffers are soon full.
const LARGE: [u32; 2] = [640, 400];

#[test]
fn a_viewer_that_never_reads_holds_little_and_is_given_up() {
    let folder = Folder::new();
    // Six seconds for a message to be taken.
    let daemon = Daemon::start(&[&folder.globe("a.relief", 8)], "", 0.2);
    let mut witness = Viewer::of(&daemon, "a");
    witness.look(down(0.0, 0.0, 3e6));
    let before = daemon.balance();
    let mut raw = Raw::welcomed(&daemon);
    let cameras: Vec<String> = (0..16).map(|k| format!("camera {k}")).collect();
    for name in &cameras {
        raw.say(&CAMERA.replace("main", name));
    }
    // It acknowledges what it never reads, so only its socket slows it down.
    let (begin, mut number) = (Instant::now(), 0);
    let mut most_bytes = 0;
    let given_up = || daemon.log().contains("it does not read");
    while !given_up() {
        assert!(begin.elapsed() < Duration::from_secs(60), "it is never given up:\n{}", daemon.log());
        number += 1;
        for name in &cameras {
            let view = format!(
                r#"{{"type":"view","camera":"{name}","view":{number},"pose":[{number},0,3e6],"shadow":"none","size":[{},{}]}}"#,
                LARGE[0], LARGE[1]
            );
            let ack = format!(r#"{{"type":"ack","camera":"{name}","seq":{number}}}"#);
            // Once it is given up nobody listens.
            let _ = raw.0.send(view.into());
            let _ = raw.0.send(ack.into());
        }
        most_bytes = most_bytes.max(daemon.balance().resident_bytes);
        // Others go on.
        witness.look(down(number as f64 % 90.0, 0.0, 3e6));
    }
    // Sixteen cameras' pictures would be 16 MB and their queues more.
    assert!(most_bytes < before.resident_bytes + (48 << 20), "{before:?} {most_bytes}");
    drop(raw);
    daemon.settles(before);
}

#[test]
fn who_acknowledges_nothing_gets_two_pictures() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    // With all tiles there each view is one picture.
    Viewer::of(&daemon, "a").look(down(1.0, 20.0, 3e6));
    let mut raw = Raw::welcomed(&daemon);
    raw.say(CAMERA);
    raw.view(1, [16, 9]);
    assert_eq!(raw.payload().0, 1);
    raw.view(2, [16, 9]);
    assert_eq!(raw.payload().0, 2);
    for number in 3..200 {
        raw.view(number, [16, 9]);
    }
    // What is answered after this was not kept back by a queue.
    raw.say(r#"{"type":"detach","camera":"nobody"}"#);
    while !raw.heard().unwrap().contains("nobody") {}
    // Acknowledging both frees the camera for the latest view alone; one of the future is no more.
    raw.ack(1 << 40);
    let (seq, view, _) = raw.payload();
    assert_eq!((seq, view), (3, 199));
}
