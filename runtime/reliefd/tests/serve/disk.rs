//! Tiles that come slower than cameras move.

use std::time::{Duration, Instant};

use relief_tests::folder::Folder;

use crate::daemon::Daemon;
use crate::viewer::{Viewer, down};

#[test]
fn coarse_pictures_come_at_once_whole_ones_later_and_nobody_waits_for_them() {
    let folder = Folder::new();
    // A tenth of a millisecond between two rounds: no tile is decoded in that.
    let daemon = Daemon::start(&[&folder.globe("a.relief", 11)], "--time-budget 0.1", 1.0);
    let mut witness = Viewer::of(&daemon, "a");
    // High above, where the coarsest tiles do.
    witness.look(down(0.0, 0.0, 2e7));
    let mut low = Viewer::of(&daemon, "a");
    let view = low.attached.view("main", down(100.0, 30.0, 2e5)).unwrap();
    let (first, _) = low.payload();
    assert!(first.view == view && !first.complete, "{first:?}");
    assert!(first.stats.tiles_missing > 0);
    let (mut pictures, mut whole) = (0, false);
    let begin = Instant::now();
    // Others fly on all the time; the low view gets whole nevertheless.
    while !whole {
        assert!(begin.elapsed() < Duration::from_secs(60), "it is never whole");
        witness.look(down(f64::from(pictures % 180), 0.0, 2e7));
        pictures += 1;
        while let Some(event) = low.attached.next_within(Duration::ZERO).unwrap() {
            if let relief_client::Event::Payload(payload) = event {
                whole |= payload.header().view == view && payload.header().complete;
            }
        }
    }
    assert!(pictures > 0);
}
