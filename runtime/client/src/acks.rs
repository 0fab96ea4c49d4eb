//! Which pictures arrived whole and are to be acknowledged.

use std::collections::BTreeMap;

use relief_protocol::payload::Header;
use relief_protocol::to_server::ToServer;

/// Who acknowledges pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Acks {
    /// The client: over a WebSocket once all payloads of a picture arrived; on the Unix socket when
    /// the event after them is asked for, as they lie in memory that is used again then.
    #[default]
    Auto,
    /// The viewer, with [`crate::Attached::ack`]: one that works on pictures elsewhere meanwhile.
    ByHand,
}

/// Payloads of pictures that are not whole yet.
#[derive(Debug, Default)]
pub(crate) struct Arrivals {
    /// By camera: the numbers of its pictures and how many of their payloads arrived.
    cameras: BTreeMap<String, BTreeMap<u64, u32>>,
    /// Acknowledgements to be sent.
    due: Vec<ToServer>,
}

impl Arrivals {
    /// Notes a payload.
    pub(crate) fn arrived(&mut self, header: &Header) {
        let pictures = self.cameras.entry(header.camera.clone()).or_default();
        let parts = pictures.entry(header.seq).or_default();
        *parts += 1;
        if *parts >= header.parts {
            // Earlier ones lost a payload on the way through the daemon.
            pictures.retain(|&seq, _| seq > header.seq);
            self.due.push(ToServer::Ack { camera: header.camera.clone(), seq: header.seq });
        }
    }

    /// The acknowledgements to be sent.
    pub(crate) fn due(&mut self) -> Vec<ToServer> {
        std::mem::take(&mut self.due)
    }

    /// Forgets a camera.
    pub(crate) fn forget(&mut self, camera: &str) {
        self.cameras.remove(camera);
        self.due.retain(|ack| ack.camera() != Some(camera));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use relief_protocol::payload::{Format, Stats, Stream};

    fn header(camera: &str, seq: u64, part: u32, parts: u32) -> Header {
        Header {
            stream: Stream::Frame,
            format: Format::Jpeg,
            camera: camera.into(),
            view: 0,
            seq,
            part,
            parts,
            size: [1, 1],
            complete: true,
            sun: [0.0; 2],
            stats: Stats::default(),
            mesh: None,
        }
    }

    #[test]
    fn a_picture_is_acknowledged_once_and_when_it_is_whole() {
        let mut arrivals = Arrivals::default();
        let ack = |camera: &str, seq| ToServer::Ack { camera: camera.into(), seq };
        arrivals.arrived(&header("a", 1, 0, 2));
        arrivals.arrived(&header("b", 1, 0, 1));
        assert_eq!(arrivals.due(), [ack("b", 1)]);
        arrivals.arrived(&header("a", 1, 1, 2));
        assert_eq!(arrivals.due(), [ack("a", 1)]);
        assert_eq!(arrivals.due(), []);
        // Payloads of two pictures may come by turns.
        arrivals.arrived(&header("a", 2, 0, 2));
        arrivals.arrived(&header("a", 3, 0, 2));
        assert_eq!(arrivals.due(), []);
        arrivals.arrived(&header("a", 2, 1, 2));
        assert_eq!(arrivals.due(), [ack("a", 2)]);
        arrivals.arrived(&header("a", 4, 0, 2));
        arrivals.arrived(&header("a", 4, 1, 2));
        assert_eq!(arrivals.due(), [ack("a", 4)]);
        assert!(arrivals.cameras.values().all(BTreeMap::is_empty), "picture 3 lost a payload");
        arrivals.arrived(&header("a", 5, 0, 1));
        arrivals.forget("a");
        assert_eq!(arrivals.due(), []);
    }
}
