//! The way over a Unix socket: messages are lines, payloads lie in rings of shared memory.

mod lines;
mod ring;

use std::collections::BTreeMap;
use std::io::Write;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_protocol::to_server::ToServer;
use relief_protocol::to_viewer::{InRing, ToViewer};

use self::lines::Lines;
pub(crate) use self::ring::InSlot;
use self::ring::Ring;
use crate::error::is_timeout;
use crate::payload::Payload;
use crate::wire::{Wire, message};
use crate::{AttachError, Event};

/// A Unix socket to a daemon.
pub(crate) struct LocalWire {
    lines: Lines,
    timeout: Duration,
    /// By camera.
    rings: BTreeMap<String, Arc<Ring>>,
}

impl LocalWire {
    /// Connects to the socket at a path.
    pub(crate) fn connect(path: &str, timeout: Duration) -> Result<Self, AttachError> {
        let timeout = timeout.max(Duration::from_millis(1));
        let connected = UnixStream::connect(path).and_then(|stream| {
            stream.set_write_timeout(Some(timeout))?;
            Ok(stream)
        });
        let stream = connected.map_err(|error| AttachError::Away { address: path.into(), error })?;
        Ok(Self { lines: Lines::new(stream), timeout, rings: BTreeMap::new() })
    }

    /// What a line means for the viewer; nothing where it is about a ring.
    fn read(&mut self, line: &str) -> Result<Option<Event>, AttachError> {
        match message(line)? {
            Some(ToViewer::Ring(ring)) => {
                let descriptor = self.lines.descriptor();
                let descriptor =
                    descriptor.ok_or_else(|| AttachError::Foreign("a ring without a descriptor".into()))?;
                self.rings.insert(ring.camera.clone(), Arc::new(Ring::map(descriptor, &ring)?));
                Ok(None)
            }
            Some(ToViewer::Payload(InRing { camera, slot, sequence, bytes })) => match self.rings.get(&camera) {
                Some(ring) => Payload::in_ring(ring.slot(slot, sequence, bytes)?).map(Event::Payload).map(Some),
                // The camera was detached meanwhile.
                None => Ok(None),
            },
            other => Ok(other.map(Event::Message)),
        }
    }
}

impl Wire for LocalWire {
    fn send(&mut self, message: &ToServer) -> Result<(), AttachError> {
        let mut line = message.text();
        line.push('\n');
        self.lines.stream().write_all(line.as_bytes()).map_err(|error| match is_timeout(&error) {
            true => AttachError::Timeout { after: self.timeout },
            false => AttachError::Lost(error),
        })?;
        if let ToServer::Detach { camera } = message {
            self.rings.remove(camera);
        }
        Ok(())
    }

    fn receive(&mut self, until: Instant) -> Result<Option<Event>, AttachError> {
        while let Some(line) = self.lines.next(until)? {
            if let Some(event) = self.read(&line)? {
                return Ok(Some(event));
            }
        }
        Ok(None)
    }
}
