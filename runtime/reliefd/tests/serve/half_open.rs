//! Connections on which nobody says anything any more.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::Instant;

use relief_protocol::error::Code;
use relief_tests::folder::Folder;

use crate::daemon::{Daemon, LONG};
use crate::raw::{CAMERA, HELLO, Raw};
use crate::viewer::{Viewer, down};

#[test]
fn silence_ends_a_connection_at_every_stage() {
    let folder = Folder::new();
    // Half a second for the hello, three for a sign of life, seven and a half for any byte.
    let daemon = Daemon::start(&[&folder.globe("a.relief", 8)], "", 0.05);
    Viewer::of(&daemon, "a").look(down(0.0, 0.0, 3e6));
    let before = daemon.balance();
    let begin = Instant::now();
    let mut connected = TcpStream::connect(daemon.address()).unwrap();
    let mut asking = TcpStream::connect(daemon.address()).unwrap();
    asking.write_all(b"GET /v1/attach HTTP/1.1\r\nHost: lo").unwrap();
    let mut upgraded = Raw::connect(&daemon);
    // What is read here is not answered: pongs go out only with the next read or write.
    let mut welcomed = Raw::connect(&daemon);
    welcomed.say(HELLO);
    welcomed.say(CAMERA);
    upgraded.is_told(Code::Timeout, true, "no hello");
    assert_eq!(upgraded.heard(), None);
    for stream in [&mut connected, &mut asking] {
        stream.set_read_timeout(Some(LONG)).unwrap();
        // It ends, with an answer or without.
        let _ = stream.read_to_end(&mut Vec::new());
    }
    assert!(begin.elapsed() < LONG, "it ended by itself");
    daemon.says("code=Some(Timeout)", 2);
    // Who answers pings stays.
    let mut witness = Viewer::of(&daemon, "a");
    let stay = Instant::now();
    while stay.elapsed().as_secs_f64() < 4.0 {
        witness.look(down(stay.elapsed().as_secs_f64(), 0.0, 3e6));
    }
    drop((connected, asking, upgraded, welcomed, witness));
    daemon.settles(before);
}

#[test]
fn a_viewer_that_is_killed_leaves_nothing_behind() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    Viewer::of(&daemon, "a").look(down(0.0, 0.0, 3e6));
    let before = daemon.balance();
    for k in 0..20 {
        let mut raw = Raw::welcomed(&daemon);
        raw.say(CAMERA);
        raw.view(k, [320, 180]);
        // Closed with unread pictures: the daemon gets a reset, in the middle of a message or not.
        drop(raw);
    }
    daemon.says("detached", 21);
    daemon.settles(before);
}
