//! Messages that no viewer should send.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};

use relief_protocol::error::Code;
use relief_tests::folder::Folder;
use tungstenite::Message;

use crate::daemon::{Daemon, LONG};
use crate::raw::{CAMERA, HELLO, Raw};
use crate::viewer::{Viewer, down};

/// A view with some fields replaced.
fn view(pose: &str, rest: &str) -> String {
    format!(r#"{{"type":"view","camera":"main","view":9,"pose":{pose},"size":[16,9]{rest}}}"#)
}

/// Messages after the hello that leave the connection as it is.
fn forgiven() -> Vec<(String, Code)> {
    let deep = "[".repeat(60_000);
    let with = |text: &str| text.to_owned();
    vec![
        (with(""), Code::Malformed),
        (with("{"), Code::Malformed),
        (with("null"), Code::Malformed),
        (deep, Code::Malformed),
        (with(r#"{"type":"fly"}"#), Code::Malformed),
        (with(HELLO), Code::Malformed),
        (format!("{HELLO}{}", " ".repeat(65 << 10)), Code::TooLarge),
        (CAMERA.replace("\"a\"", "\"pluto\""), Code::Unknown),
        (CAMERA.replace("rgba", "gif"), Code::Malformed),
        (with(r#"{"type":"detach","camera":"nobody"}"#), Code::Unknown),
        (with(r#"{"type":"pick","camera":"nobody","x":1,"y":1}"#), Code::Unknown),
        (with(r#"{"type":"pick","camera":"main","x":-1,"y":1}"#), Code::BadView),
        (view("[NaN,0,1000]", ""), Code::Malformed),
        (view("[0,0,Infinity]", ""), Code::Malformed),
        (view("[0,0,1e999]", ""), Code::Malformed),
        (view("[0,0,1e308]", ""), Code::BadView),
        (view("[0,1e308,1000]", ""), Code::BadView),
        (view("[0,91,1000]", ""), Code::BadView),
        (view("[0,0]", ""), Code::BadView),
        (view("[0,0,1,2,3,4,5]", ""), Code::BadView),
        (view("[0,0,1000]", r#","fov":0"#), Code::BadView),
        (view("[0,0,1000]", r#","fov":1e300"#), Code::BadView),
        (view("[0,0,1000]", r#","pixel_error":1e39"#), Code::BadView),
        (view("[0,0,1000]", r#","pixel_error":-1"#), Code::BadView),
        (view("[0,0,1000]", r#","air":1e39"#), Code::BadView),
        (view("[0,0,1000]", r#","sun":[0,95]"#), Code::BadView),
        (view("[0,0,1000]", r#","sun":[0,1e300]"#), Code::BadView),
        (view("[0,0,1000]", r#","time":"tomorrow"}"#), Code::Malformed),
        (view("[0,0,1000]", r#","time":"tomorrow""#), Code::BadView),
        (view("[0,0,1000]", r#","shadow":"paper""#), Code::BadView),
        (view("[0,0,1000]", "").replace("[16,9]", "[0,9]"), Code::BadView),
        (view("[0,0,1000]", "").replace("[16,9]", "[4000000000,4000000000]"), Code::TooLarge),
        (view("[0,0,1000]", "").replace("[16,9]", "[-1,9]"), Code::Malformed),
        (view("[0,0,1000]", "").replace("main", "other"), Code::Unknown),
    ]
}

/// Ends a flight, whatever happens.
struct Landed<'a>(&'a AtomicBool);

impl Drop for Landed<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Relaxed);
    }
}

#[test]
fn who_breaks_the_rules_is_told_and_others_go_on() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    let mut witness = Viewer::of(&daemon, "a");
    witness.look(down(0.0, 20.0, 3e6));
    let before = daemon.balance();
    let going = AtomicBool::new(true);
    std::thread::scope(|scope| {
        let _landed = Landed(&going);
        // While all of this goes on, somebody flies.
        let flight = scope.spawn(|| {
            let mut pictures = 0;
            while going.load(Ordering::Relaxed) {
                witness.look(down(f64::from(pictures % 90), 20.0, 3e6));
                pictures += 1;
            }
            (pictures, witness)
        });
        let mut raw = Raw::welcomed(&daemon);
        raw.say(CAMERA);
        raw.view(1, [16, 9]);
        let (seq, ..) = raw.payload();
        raw.ack(seq);
        for (text, code) in forgiven() {
            raw.say(&text);
            let fault = raw.is_told(code, false, &format!("{text:.100}"));
            assert!(text.len() < 70 || fault.what.len() < 500, "{fault}");
        }
        // Acks of what never was buy nothing and cost nothing.
        raw.ack(u64::MAX);
        raw.say(r#"{"type":"ack","camera":"nobody","seq":1}"#);
        raw.view(7, [16, 9]);
        while raw.payload().1 != 7 {}
        drop(raw);
        drop(Landed(&going));
        let (pictures, witness) = flight.join().unwrap();
        assert!(pictures > 1 && witness.told.is_empty(), "{pictures} {:?}", witness.told);
    });
    daemon.settles(before);
}

#[test]
fn who_does_not_speak_the_protocol_is_told_and_let_go() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    let before = daemon.balance();
    let cases: [(&str, Message, Code); 8] = [
        ("a message before the hello", Message::text(CAMERA), Code::Malformed),
        ("no JSON", Message::text("GET / HTTP/1.1"), Code::Malformed),
        ("another version", Message::text(HELLO.replace('1', "2")), Code::Version),
        ("a version of the future", Message::text(HELLO.replace('1', "4294967295")), Code::Version),
        ("a version that is none", Message::text(HELLO.replace('1', "-1")), Code::Malformed),
        ("binary junk", Message::binary(vec![0xa5; 5000]), Code::Malformed),
        ("nothing", Message::binary(Vec::new()), Code::Malformed),
        ("a hello of 65 KiB", Message::text(format!("{HELLO}{}", " ".repeat(65 << 10))), Code::TooLarge),
    ];
    for (about, message, code) in cases {
        let mut raw = Raw::connect(&daemon);
        raw.0.send(message).unwrap();
        raw.is_told(code, true, about);
        assert_eq!(raw.heard(), None, "{about}");
    }
    // After the hello, too.
    let mut raw = Raw::welcomed(&daemon);
    raw.0.send(Message::binary(vec![1, 2, 3])).unwrap();
    raw.is_told(Code::Malformed, true, "binary junk after the hello");
    assert_eq!(raw.heard(), None);
    daemon.settles(before);
}

#[test]
fn what_is_no_websocket_and_no_http_ends_without_harm() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    let before = daemon.balance();
    // Frames as bytes: fin and text, masked, lengths and contents that no client would send.
    let frames: [(&str, &[u8]); 6] = [
        ("text that is no UTF-8", &[0x81, 0x82, 0, 0, 0, 0, 0xff, 0xfe]),
        ("a frame without a mask", &[0x81, 0x02, b'{', b'}']),
        ("an unknown kind of frame", &[0x83, 0x80, 0, 0, 0, 0]),
        ("a frame of 2^62 bytes", &[0x81, 0xff, 0x40, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        ("a ping of 130 bytes", &[&[0x89, 0xfe, 0, 130, 0, 0, 0, 0][..], &[7; 130]].concat()),
        ("a continuation of nothing", &[0x80, 0x80, 0, 0, 0, 0]),
    ];
    for (about, bytes) in frames {
        let mut raw = Raw::connect(&daemon);
        raw.0.get_mut().write_all(bytes).unwrap();
        raw.is_told(Code::Malformed, true, about);
    }
    let requests: [(&str, &[u8], &str); 6] = [
        ("TLS", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03junkjunkjunk\r\n\r\n", ""),
        ("noise", &[0xa5; 20_000], ""),
        (
            "attaching without an upgrade",
            b"GET /v1/attach HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
            "HTTP/1.1 4",
        ),
        (
            "a method that is none",
            b"FLY /v1/attach HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
            "HTTP/1.1 4",
        ),
        (
            "a path that is none",
            b"GET /../../etc/passwd HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
            "HTTP/1.1 4",
        ),
        ("an endless header", &[b'a'; 900_000], ""),
    ];
    for (about, bytes, expected) in requests {
        let mut stream = TcpStream::connect(daemon.address()).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        // It may be refused before all is written.
        let _ = stream.write_all(bytes);
        if expected.is_empty() {
            let _ = stream.shutdown(std::net::Shutdown::Write);
        }
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer);
        assert!(answer.starts_with(expected) && !answer.starts_with("HTTP/1.1 2"), "{about}: {answer:.200}");
    }
    Viewer::of(&daemon, "a").look(down(0.0, 0.0, 3e6));
    daemon.settles(before);
}

#[test]
fn the_seventeenth_camera_is_refused() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    let mut raw = Raw::welcomed(&daemon);
    for k in 0..17 {
        raw.say(&CAMERA.replace("main", &format!("camera {k}")));
    }
    let fault = raw.is_told(Code::TooLarge, false, "17 cameras");
    assert_eq!(fault.camera.as_deref(), Some("camera 16"));
    // One goes, one comes; one that is there may be changed.
    raw.say(r#"{"type":"detach","camera":"camera 3"}"#);
    raw.say(CAMERA);
    raw.say(CAMERA);
    raw.view(5, [16, 9]);
    assert_eq!(raw.payload().1, 5);
}
