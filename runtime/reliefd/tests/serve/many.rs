//! Many viewers, one after the other and at a time.

use std::thread;

use relief_client::{Attached, Options};
use relief_protocol::error::Code;
use relief_tests::folder::Folder;

use crate::daemon::{Daemon, LONG};
use crate::raw::{HELLO, Raw};
use crate::viewer::{Viewer, down};

#[test]
fn a_thousand_connects_leave_nothing_behind() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    let mut witness = Viewer::of(&daemon, "a");
    witness.look(down(0.0, 0.0, 3e6));
    // What it takes once.
    (0..50).for_each(|_| drop(Raw::welcomed(&daemon)));
    daemon.says("detached", 50);
    let before = daemon.balance();
    for k in 0..1000 {
        drop(Raw::welcomed(&daemon));
        if k % 100 == 0 {
            witness.look(down(f64::from(k), 0.0, 3e6));
        }
    }
    daemon.says("detached", 1050);
    daemon.settles(before);
    assert!(witness.told.is_empty());
}

#[test]
fn three_hundred_at_a_time_get_a_seat_or_a_word() {
    let folder = Folder::new();
    let daemon = Daemon::start(&[&folder.globe("a.relief", 8)], "--max-viewers 250", 1.0);
    Viewer::of(&daemon, "a").look(down(0.0, 0.0, 3e6));
    daemon.says("detached", 1);
    wave(&daemon);
    daemon.says("detached", 251);
    // What the first wave leaves is what the second takes.
    let before = daemon.balance();
    wave(&daemon);
    daemon.says("detached", 501);
    // A seat that was left is free.
    Viewer::of(&daemon, "a").look(down(5.0, 0.0, 3e6));
    daemon.settles(before);
    assert!(!daemon.log().contains(&format!("{:?}", Code::Internal)));
}

/// 300 viewers at a time, of which 250 get a seat.
fn wave(daemon: &Daemon) {
    let mut raws: Vec<Raw> = thread::scope(|scope| {
        let joins: Vec<_> = (0..10)
            .map(|_| {
                scope.spawn(|| {
                    let connect = |_| {
                        let mut raw = Raw::connect(daemon);
                        // It may be told that there is no seat before it can say hello.
                        let _ = raw.0.send(HELLO.into());
                        raw
                    };
                    (0..30).map(connect).collect::<Vec<_>>()
                })
            })
            .collect();
        joins.into_iter().flat_map(|join| join.join().unwrap()).collect()
    });
    let (mut seated, mut busy) = (0, 0);
    for raw in &mut raws {
        match raw.heard() {
            Some(text) if text.contains("\"welcome\"") => seated += 1,
            Some(text) => {
                assert!(text.contains("\"busy\"") && text.contains("--max-viewers"), "{text}");
                busy += 1;
            }
            None => panic!("neither a seat nor a word"),
        }
    }
    assert_eq!((seated, busy), (250, 50));
    let refused = Attached::to(daemon.address(), &Options { timeout: LONG, ..Options::default() }).err().unwrap();
    assert!(refused.to_string().contains("250 viewers"), "{refused}");
}
