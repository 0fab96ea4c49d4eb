//! A file that is cut while it is mapped.

use relief_protocol::error::Code;
use relief_protocol::to_viewer::ToViewer;
use relief_tests::folder::Folder;

use crate::daemon::Daemon;
use crate::viewer::{Viewer, down};

#[test]
fn a_cut_file_ends_nobody_and_a_whole_one_heals_it() {
    let folder = Folder::new();
    let (path, good) = (folder.globe("a.relief", 12), folder.path("good"));
    std::fs::copy(&path, &good).unwrap();
    let daemon = Daemon::start(&[&path, &folder.globe("b.relief", 9)], "", 0.05);
    let (mut viewer, mut other) = (Viewer::of(&daemon, "a"), Viewer::of(&daemon, "b"));
    viewer.look(down(10.0, 10.0, 3e6));
    other.look(down(10.0, 10.0, 1e5));
    let file = std::fs::File::options().write(true).open(&path).unwrap();
    file.set_len(file.metadata().unwrap().len() / 2).unwrap();
    // All over the globe and low, so that tiles are needed that were cut off.
    for k in 0..12 {
        viewer.look(down(f64::from(k) * 30.0 - 175.0, 50.0 - f64::from(k) * 9.0, 1e5));
    }
    for what in ["a: the new file cannot be opened", "damaged tiles"] {
        let fault = viewer.message(|message| match message {
            ToViewer::Error(fault) if fault.what.contains(what) => Some(fault.clone()),
            _ => None,
        });
        assert!(fault.code == Code::Damaged && fault.what.starts_with("a: ") && !fault.fatal, "{fault}");
    }
    other.look(down(-100.0, -50.0, 1e5));
    std::fs::rename(&good, &path).unwrap();
    viewer.message(|message| matches!(message, ToViewer::Planet(_)).then_some(()));
    viewer.told.clear();
    for k in 0..4 {
        viewer.look(down(f64::from(k) * 30.0, 20.0, 1e5));
    }
    let damaged = |message: &ToViewer| matches!(message, ToViewer::Error(_));
    assert!(!viewer.told.iter().any(damaged), "{:?}", viewer.told);
}
