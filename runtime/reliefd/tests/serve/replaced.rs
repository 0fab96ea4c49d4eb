//! A file that is replaced, spoiled or deleted while it is served.

use std::path::Path;

use relief_formats::body::Body;
use relief_protocol::error::Code;
use relief_protocol::to_viewer::ToViewer;
use relief_tests::folder::Folder;
use relief_tests::sample_file::Sample;

use crate::daemon::Daemon;
use crate::viewer::{Viewer, down};

/// Patience: the files are looked at 20 times a second.
const PATIENCE: f64 = 0.05;

fn flat(path: &Path, q: fn(relief_formats::grid::Grid, u32, u32) -> i32) {
    let next = path.with_extension("next");
    Sample { q, ..Sample::new(Body::earth(), 8) }.write(&next);
    std::fs::rename(next, path).unwrap();
}

fn is_replaced(message: &ToViewer) -> Option<(f64, f64)> {
    match message {
        ToViewer::Planet(planet) if planet.name == "a" => Some((planet.min_m, planet.max_m)),
        _ => None,
    }
}

#[test]
fn a_replaced_file_is_shown_without_being_asked_for() {
    let folder = Folder::new();
    let path = folder.path("a.relief");
    flat(&path, |_, _, _| 16);
    let daemon = Daemon::start(&[&path, &folder.globe("b.relief", 8)], "", PATIENCE);
    let (mut viewer, mut other) = (Viewer::of(&daemon, "a"), Viewer::of(&daemon, "b"));
    let (_, before) = viewer.look(down(10.0, 10.0, 3e6));
    other.look(down(10.0, 10.0, 3e6));
    let held = daemon.balance();
    for (round, q) in [|_, _, _| 160_000, |_, _, _| 16].into_iter().enumerate() {
        flat(&path, q);
        // Once by a signal, once by itself.
        if round == 0 {
            daemon.signal("HUP");
        }
        let (min_m, _) = viewer.message(is_replaced);
        assert_eq!(min_m, if round == 0 { 10_000.0 } else { 1.0 });
        // Drawn anew without being asked.
        let (header, now) = loop {
            let (header, bytes) = viewer.payload();
            if header.complete {
                break (header, bytes);
            }
        };
        assert_eq!(header.view, 1);
        assert_eq!(now == before, round == 1, "other heights have other colours");
    }
    other.look(down(11.0, 10.0, 3e6));
    // The map and the tiles of the file before are gone.
    daemon.settles(held);
}

#[test]
fn a_bad_or_missing_file_is_told_of_and_the_one_before_is_shown() {
    let folder = Folder::new();
    let path = folder.path("a.relief");
    flat(&path, |_, _, _| 16);
    let daemon = Daemon::start(&[&path], "", PATIENCE);
    let mut viewer = Viewer::of(&daemon, "a");
    let (_, before) = viewer.look(down(10.0, 10.0, 3e6));
    let held = daemon.balance();
    // Published by rename, so that the file that is mapped stays whole.
    let spoiled = folder.path("spoiled");
    std::fs::write(&spoiled, b"no relief").unwrap();
    std::fs::rename(&spoiled, &path).unwrap();
    let fault = viewer.fault(Code::Damaged);
    assert!(fault.what.contains("a: the new file cannot be opened") && !fault.fatal, "{fault}");
    daemon.says("the new file cannot be served", 1);
    viewer.look(down(20.0, 10.0, 3e6));
    // A whole file whose coarsest tile is damaged is refused by the engine.
    let mut bytes = {
        Sample::new(Body::earth(), 8).write(&spoiled);
        std::fs::read(&spoiled).unwrap()
    };
    let middle = bytes.len() / 2;
    bytes[middle..][..64].fill(0x5a);
    std::fs::write(&spoiled, bytes).unwrap();
    std::fs::rename(&spoiled, &path).unwrap();
    let fault = viewer.fault(Code::Damaged);
    assert!(fault.what.contains("the replaced file cannot be shown"), "{fault}");
    viewer.look(down(21.0, 10.0, 3e6));
    std::fs::remove_file(&path).unwrap();
    daemon.says("the file is gone", 1);
    assert_eq!(viewer.look(down(10.0, 10.0, 3e6)).1, before);
    // It comes back.
    flat(&path, |_, _, _| 160_000);
    assert_eq!(viewer.message(is_replaced).0, 10_000.0);
    assert_eq!(daemon.log().matches("the file is gone").count(), 1, "once is enough");
    assert_eq!(daemon.log().matches("the new file cannot be served").count(), 1);
    daemon.settles(held);
}
