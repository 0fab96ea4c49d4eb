//! Viewers that keep to the protocol.

use std::time::{Duration, Instant};

use relief_client::{Acks, Attached, Event, Options};
use relief_protocol::error::{Code, Fault};
use relief_protocol::payload::Header;
use relief_protocol::to_server::{Frame, FrameFormat, Streams};
use relief_protocol::to_viewer::ToViewer;
use relief_protocol::view::View;

use crate::daemon::{Daemon, LONG};

/// Pixels of most pictures: small, so that tests are quick.
pub const SIZE: [u32; 2] = [64, 36];

/// Frames without packing.
pub fn rgba() -> Streams {
    Streams { frame: Some(Frame { format: FrameFormat::Rgba, ..Frame::default() }), ..Streams::default() }
}

/// Straight down from a height.
pub fn down(lon: f64, lat: f64, height_m: f64) -> View {
    View::down([lon, lat, height_m], SIZE)
}

/// A viewer with a camera "main" of a planet.
pub struct Viewer {
    pub attached: Attached,
    /// What it was told that is no payload.
    pub told: Vec<ToViewer>,
}

impl Viewer {
    pub fn of(daemon: &Daemon, planet: &str) -> Self {
        let options = Options { timeout: LONG, acks: Acks::Auto, ..Options::default() };
        let mut attached = Attached::to(daemon.address(), &options).unwrap();
        attached.camera("main", planet, rgba()).unwrap();
        Self { attached, told: Vec::new() }
    }

    /// The next payload.
    pub fn payload(&mut self) -> (Header, Vec<u8>) {
        loop {
            match self.attached.next_event().unwrap() {
                Event::Payload(payload) => return (payload.header().clone(), payload.copied().unwrap()),
                Event::Message(message) => self.told.push(message),
            }
        }
    }

    /// Asks for a view and waits for its whole picture.
    pub fn look(&mut self, what: View) -> (Header, Vec<u8>) {
        let view = self.attached.view("main", what).unwrap();
        loop {
            let (header, bytes) = self.payload();
            if header.view == view && header.complete {
                return (header, bytes);
            }
        }
    }

    /// Waits for a fault.
    pub fn fault(&mut self, code: Code) -> Fault {
        self.message(|message| match message {
            ToViewer::Error(fault) if fault.code == code => Some(fault.clone()),
            _ => None,
        })
    }

    /// Waits for a message, which may have come already.
    pub fn message<T>(&mut self, wanted: impl Fn(&ToViewer) -> Option<T>) -> T {
        let deadline = Instant::now() + LONG;
        loop {
            if let Some(at) = self.told.iter().position(|message| wanted(message).is_some()) {
                return wanted(&self.told.remove(at)).unwrap();
            }
            assert!(Instant::now() < deadline, "{:?}", self.told);
            match self.attached.next_within(Duration::from_millis(200)).unwrap() {
                Some(Event::Message(message)) => self.told.push(message),
                Some(Event::Payload(_)) | None => {}
            }
        }
    }
}
