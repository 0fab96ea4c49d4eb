//! What comes from a daemon: messages, and payloads wherever they lie.

use relief_protocol::mesh::{self, Vertex};
use relief_protocol::payload::{EnvelopeError, Header};
use relief_protocol::to_viewer::ToViewer;
use tungstenite::Bytes;

use crate::AttachError;
#[cfg(target_os = "linux")]
use crate::local::InSlot;

/// What comes from a daemon.
#[derive(Debug)]
pub enum Event {
    /// A picture, mask, depth or mesh.
    Payload(Payload),
    /// Anything else, faults that are not fatal among it.
    Message(ToViewer),
}

/// A payload in shared memory was overwritten while it was in use: what was read of it is void.
///
/// It happens only to viewers that acknowledge a picture before they have used it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "slot {slot} of a ring holds number {found}, not {announced}: what was read there is void\n  rule: a payload in shared memory is used before its picture is acknowledged\n  remedy: acknowledge later, or copy first"
)]
pub struct Torn {
    /// The slot.
    pub slot: u32,
    /// Its number, by the daemon's message.
    pub announced: u64,
    /// Its number now.
    pub found: u64,
}

/// A payload and what it is.
#[derive(Debug)]
pub struct Payload {
    header: Header,
    place: Place,
    /// Where the payload begins.
    start: usize,
}

/// Where an envelope lies.
#[derive(Debug)]
enum Place {
    /// In memory of its own.
    Own(Bytes),
    /// In a slot of a ring.
    #[cfg(target_os = "linux")]
    Ring(InSlot),
}

impl Payload {
    /// From an envelope that came whole.
    pub(crate) fn own(envelope: Bytes) -> Result<Self, AttachError> {
        let (header, payload) = Header::open(&envelope).map_err(|error| foreign(&error))?;
        let start = envelope.len() - payload.len();
        Ok(Self { header, start, place: Place::Own(envelope) })
    }

    /// From an envelope in a ring.
    #[cfg(target_os = "linux")]
    pub(crate) fn in_ring(slot: InSlot) -> Result<Self, AttachError> {
        // A copy of the header is read, not the memory, which changes where the daemon breaks its word.
        let copy = slot.with(|bytes| {
            let length = bytes.first_chunk().map_or(0, |length| u32::from_le_bytes(*length) as usize);
            let start = 4usize.saturating_add(length);
            (start, bytes.get(..start).unwrap_or(bytes).to_vec())
        });
        let (start, envelope) = copy?;
        let (header, _) = Header::open(&envelope).map_err(|error| foreign(&error))?;
        Ok(Self { header, start, place: Place::Ring(slot) })
    }

    /// What it is.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Looks at the bytes, without a copy. In shared memory they may change meanwhile; what the
    /// closure made of them is given out only where they did not.
    ///
    /// # Errors
    /// [`Torn`] where they were overwritten.
    pub fn with<T>(&self, read: impl FnOnce(&[u8]) -> T) -> Result<T, Torn> {
        let read = |envelope: &[u8]| read(envelope.get(self.start..).unwrap_or_default());
        match &self.place {
            Place::Own(envelope) => Ok(read(envelope)),
            #[cfg(target_os = "linux")]
            Place::Ring(slot) => slot.with(read),
        }
    }

    /// The bytes, copied.
    ///
    /// # Errors
    /// [`Torn`] where they were overwritten.
    pub fn copied(&self) -> Result<Vec<u8>, Torn> {
        self.with(<[u8]>::to_vec)
    }

    /// Vertices, and indices of which three are a triangle; none unless the payload is a mesh.
    ///
    /// # Errors
    /// [`AttachError::Torn`], or [`AttachError::Foreign`] for a mesh that does not hold together.
    #[expect(clippy::type_complexity, reason = "the two halves of a mesh need no name of their own")]
    pub fn mesh(&self) -> Result<Option<(Vec<Vertex>, Vec<u32>)>, AttachError> {
        let Some(counts) = self.header.mesh else { return Ok(None) };
        let mesh = self.with(|bytes| mesh::unpack(bytes, counts.vertices, counts.indices))?;
        mesh.map(Some).map_err(AttachError::Foreign)
    }

    /// Whether it lies in shared memory that the daemon uses again after the acknowledgement.
    pub(crate) fn is_shared(&self) -> bool {
        !matches!(self.place, Place::Own(_))
    }
}

fn foreign(error: &EnvelopeError) -> AttachError {
    AttachError::Foreign(error.to_string())
}
