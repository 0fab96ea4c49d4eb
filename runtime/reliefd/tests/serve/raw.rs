//! A viewer that says whatever it likes.

use std::net::TcpStream;
use std::time::{Duration, Instant};

use relief_protocol::error::{Code, Fault};
use relief_protocol::to_viewer::ToViewer;
use serde_json::Value;
use tungstenite::{Message, WebSocket};

use crate::daemon::{Daemon, LONG};

/// A hello.
pub const HELLO: &str = r#"{"type":"hello","version":1}"#;
/// A camera of the planet `a`.
pub const CAMERA: &str = r#"{"type":"camera","camera":"main","planet":"a","streams":{"frame":{"format":"rgba"}}}"#;

pub struct Raw(pub WebSocket<TcpStream>);

impl Raw {
    /// Connects and upgrades; says nothing.
    pub fn connect(daemon: &Daemon) -> Self {
        let stream = TcpStream::connect(daemon.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        stream.set_write_timeout(Some(LONG)).unwrap();
        Self(tungstenite::client(format!("ws://{}/v1/attach", daemon.address()), stream).unwrap().0)
    }

    /// One that was welcomed.
    pub fn welcomed(daemon: &Daemon) -> Self {
        let mut raw = Self::connect(daemon);
        raw.say(HELLO);
        let welcome = raw.heard().unwrap();
        assert!(welcome.contains("\"welcome\""), "{welcome}");
        raw
    }

    pub fn say(&mut self, text: &str) {
        self.0.send(Message::text(text)).unwrap();
    }

    /// A view of the camera "main".
    pub fn view(&mut self, number: u64, size: [u32; 2]) {
        let [width, height] = size;
        let (lon, pose) = (number % 360, format!("{},20,3e6", number % 360));
        self.say(&format!(
            r#"{{"type":"view","camera":"main","view":{number},"pose":[{pose}],"sun":[{lon},0],"size":[{width},{height}]}}"#
        ));
    }

    /// The next text; none once the connection has ended. Payloads are passed over.
    pub fn heard(&mut self) -> Option<String> {
        let deadline = Instant::now() + LONG;
        loop {
            assert!(Instant::now() < deadline, "nothing is said but pings");
            match self.0.read() {
                Ok(Message::Text(text)) => return Some(text.to_string()),
                Ok(Message::Close(_)) => {}
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if error.kind() == std::io::ErrorKind::WouldBlock => {
                    panic!("nothing was said")
                }
                Err(_) => return None,
            }
        }
    }

    /// The next fault; none once the connection has ended.
    pub fn fault(&mut self) -> Option<Fault> {
        while let Some(text) = self.heard() {
            if let Ok(ToViewer::Error(fault)) = ToViewer::parse(&text) {
                return Some(fault);
            }
        }
        None
    }

    /// The next fault is this one, in words that help.
    pub fn is_told(&mut self, code: Code, fatal: bool, about: &str) -> Fault {
        let fault = self.fault().unwrap_or_else(|| panic!("the connection ended without a word: {about}"));
        assert_eq!((fault.code, fault.fatal), (code, fatal), "{about}: {fault}");
        assert!(!fault.what.is_empty() && !fault.rule.is_empty() && !fault.remedy.is_empty(), "{about}: {fault:?}");
        fault
    }

    /// Number, view and `complete` of the next payload.
    pub fn payload(&mut self) -> (u64, u64, bool) {
        loop {
            if let Message::Binary(bytes) = self.0.read().unwrap() {
                let (header, _) = relief_protocol::payload::Header::open(&bytes).unwrap();
                return (header.seq, header.view, header.complete);
            }
        }
    }

    /// Acknowledges a picture of "main".
    pub fn ack(&mut self, seq: u64) {
        self.say(&Value::to_string(&serde_json::json!({ "type": "ack", "camera": "main", "seq": seq })));
    }
}
