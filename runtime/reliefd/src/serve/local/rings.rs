//! The rings of a viewer, one a camera.

use std::os::fd::BorrowedFd;

use relief_protocol::payload::Header;
use relief_protocol::ring::{Layout, MOST_SLOT_BYTES, MOST_SLOTS};
use relief_protocol::to_viewer::{self, InRing, ToViewer};
use relief_protocol::{MOST_CAMERAS, MOST_UNACKNOWLEDGED};

use super::ring::Ring;

/// Rings, the one that was used latest last.
#[derive(Debug, Default)]
pub struct Rings(Vec<(String, Ring)>);

/// A payload in a ring.
#[derive(Debug)]
pub struct Placed<'a> {
    /// A ring that the viewer does not know yet: it must be told first, with the descriptor.
    pub ring: Option<(ToViewer, BorrowedFd<'a>)>,
    /// Where the payload is.
    pub payload: ToViewer,
}

impl Rings {
    /// Copies a payload into its camera's ring, or into a new one where it outgrows that.
    ///
    /// # Errors
    /// What the system says, or a payload that is larger than any ring.
    pub fn place(&mut self, header: &Header, payload: &[u8]) -> std::io::Result<Placed<'_>> {
        let envelope = header.envelope();
        let bytes = (envelope.len() + payload.len()) as u64;
        let slots = slots(header.parts);
        let known = self.0.iter().position(|(camera, _)| *camera == header.camera).map(|at| self.0.remove(at).1);
        let fits = |ring: &Ring| ring.layout().slots() >= slots && ring.layout().slot_bytes() >= bytes;
        let old = known.filter(fits);
        let is_new = old.is_none();
        let ring = old.map_or_else(|| Ring::new(layout(slots, bytes)?), Ok)?;
        self.0.push((header.camera.clone(), ring));
        if self.0.len() > MOST_CAMERAS {
            // Of a camera that was detached: there are no more. Should it live, it gets a new one.
            self.0.remove(0);
        }
        let Some((camera, ring)) = self.0.last_mut() else { return Err(too_large(bytes)) };
        let Some((slot, sequence)) = ring.write(&envelope, payload) else { return Err(too_large(bytes)) };
        let (camera, layout) = (camera.clone(), ring.layout());
        let announced = is_new.then(|| {
            let (slots, slot_bytes, bytes) = (layout.slots(), layout.slot_bytes(), layout.bytes());
            let ring_of = to_viewer::Ring { camera: camera.clone(), slots, slot_bytes, bytes };
            (ToViewer::Ring(ring_of), ring.descriptor())
        });
        Ok(Placed { ring: announced, payload: ToViewer::Payload(InRing { camera, slot, sequence, bytes }) })
    }
}

/// Slots for the payloads of the pictures that may be unacknowledged, and of one more.
fn slots(parts: u32) -> u32 {
    parts.max(1).saturating_mul(MOST_UNACKNOWLEDGED as u32 + 1).min(MOST_SLOTS)
}

fn layout(slots: u32, bytes: u64) -> std::io::Result<Layout> {
    let room = bytes.checked_next_power_of_two().map(|room| room.min(MOST_SLOT_BYTES).max(bytes));
    room.and_then(|room| Layout::new(slots, room)).ok_or_else(|| too_large(bytes))
}

fn too_large(bytes: u64) -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::FileTooLarge, format!("a payload of {bytes} bytes is larger than any ring"))
}
