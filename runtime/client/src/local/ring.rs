//! A ring as its reader maps it: see [`relief_protocol::ring`].
#![allow(unsafe_code, reason = "shared memory: each use gives its reason")]

use std::fs::File;
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering, fence};

use memmap2::{MmapOptions, MmapRaw};
use relief_protocol::ring::{HEAD_BYTES, Layout};
use relief_protocol::to_viewer;
use rustix::fs::{SealFlags, fcntl_get_seals};

use crate::{AttachError, Torn};

/// A ring, mapped read-only. Unmapped when the last payload in it is dropped.
#[derive(Debug)]
pub(crate) struct Ring {
    map: MmapRaw,
    layout: Layout,
}

impl Ring {
    /// Maps a ring that a daemon announced, if nobody can shrink it.
    pub(super) fn map(descriptor: OwnedFd, announced: &to_viewer::Ring) -> Result<Self, AttachError> {
        let foreign = |what: String| AttachError::Foreign(format!("a ring of {} bytes {what}", announced.bytes));
        let seals = fcntl_get_seals(&descriptor).map_err(|error| foreign(format!("without seals: {error}")))?;
        if !seals.contains(SealFlags::SHRINK) {
            return Err(foreign("that may shrink".into()));
        }
        let file = File::from(descriptor);
        let bytes = file.metadata().map_err(AttachError::Lost)?.len();
        if bytes != announced.bytes || bytes < HEAD_BYTES as u64 {
            return Err(foreign(format!("whose memory has {bytes} bytes")));
        }
        let map = MmapOptions::new().map_raw_read_only(&file).map_err(AttachError::Lost)?;
        // SAFETY: the map has at least HEAD_BYTES bytes, sealed against shrinking. They are copied at
        // once, and no value of bytes is wrong for an array of them.
        let head: [u8; HEAD_BYTES] = unsafe { map.as_ptr().cast::<[u8; HEAD_BYTES]>().read_volatile() };
        match Layout::read(&head, bytes) {
            Some(layout) if (layout.slots(), layout.slot_bytes()) == (announced.slots, announced.slot_bytes) => {
                Ok(Self { map, layout })
            }
            _ => Err(foreign("with a head that is none of a ring, or of another".into())),
        }
    }

    /// A payload that a daemon announced.
    pub(super) fn slot(self: &Arc<Self>, slot: u32, sequence: u64, bytes: u64) -> Result<InSlot, AttachError> {
        if slot >= self.layout.slots() || bytes > self.layout.slot_bytes() {
            return Err(AttachError::Foreign(format!(
                "a payload of {bytes} bytes in slot {slot} of {:?}",
                self.layout
            )));
        }
        Ok(InSlot { ring: Arc::clone(self), slot, sequence, bytes: bytes as usize })
    }

    /// The sequence number of a slot that is there.
    fn sequence(&self, slot: u32) -> &AtomicU64 {
        let at = self.layout.sequence(slot) as usize;
        // SAFETY: `Layout::read` found that all sequence numbers lie inside the map, which is sealed
        // against shrinking and lives as long as `self`; a map begins at a page and numbers lie at
        // multiples of 64. Both processes access them atomically only, this one never writes.
        unsafe { AtomicU64::from_ptr(self.map.as_ptr().add(at).cast::<u64>().cast_mut()) }
    }
}

/// A payload in a slot, with the number that the slot has as long as it is there.
#[derive(Debug)]
pub(crate) struct InSlot {
    ring: Arc<Ring>,
    slot: u32,
    sequence: u64,
    bytes: usize,
}

impl InSlot {
    /// Looks at the envelope and gives out what was seen only if nothing was overwritten meanwhile.
    pub(crate) fn with<T>(&self, read: impl FnOnce(&[u8]) -> T) -> Result<T, Torn> {
        let number = self.ring.sequence(self.slot);
        self.check(u64::from_le(number.load(Ordering::Acquire)))?;
        let at = self.ring.layout.slot(self.slot) as usize;
        // SAFETY: `Ring::slot` found the bytes inside the slot, `Layout::read` the slot inside the map,
        // which is sealed against shrinking and lives as long as `self`. The daemon does not write to
        // a slot that it announced before the picture is acknowledged; should it, the slice changes
        // under the closure, as a mapped file would, and its result is thrown away below.
        let out = read(unsafe { std::slice::from_raw_parts(self.ring.map.as_ptr().add(at), self.bytes) });
        // What was read above is read before the number is read again.
        fence(Ordering::Acquire);
        self.check(u64::from_le(number.load(Ordering::Relaxed)))?;
        Ok(out)
    }

    fn check(&self, found: u64) -> Result<(), Torn> {
        match found == self.sequence {
            true => Ok(()),
            false => Err(Torn { slot: self.slot, announced: self.sequence, found }),
        }
    }
}
