//! A ring as its writer sees it: see [`relief_protocol::ring`].
#![allow(unsafe_code, reason = "shared memory: each use gives its reason")]

use std::fs::File;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::FileExt;
use std::sync::Once;
use std::sync::atomic::{AtomicU64, Ordering, fence};

use memmap2::MmapRaw;
use relief_protocol::ring::Layout;
use rustix::fs::{MemfdFlags, SealFlags, fcntl_add_seals, memfd_create};

/// Shared memory that this process writes and viewers read.
#[derive(Debug)]
pub struct Ring {
    memory: File,
    map: MmapRaw,
    layout: Layout,
    /// The slot that was used longest ago.
    next: u32,
}

impl Ring {
    /// An empty ring. Its pages are taken from memory when they are first written.
    ///
    /// # Errors
    /// What the system says: no descriptors, no memory.
    pub fn new(layout: Layout) -> std::io::Result<Self> {
        let memory = File::from(memfd_create("relief ring", MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING)?);
        memory.set_len(layout.bytes())?;
        memory.write_all_at(&layout.head(), 0)?;
        // Who could shrink it could end the other end with a SIGBUS.
        fcntl_add_seals(&memory, SealFlags::SHRINK | SealFlags::GROW)?;
        let map = MmapRaw::map_raw(&memory)?;
        // From here on nobody gets to write but through this map.
        if let Err(error) = fcntl_add_seals(&memory, SealFlags::FUTURE_WRITE | SealFlags::SEAL) {
            static TOLD: Once = Once::new();
            TOLD.call_once(|| {
                tracing::warn!("this kernel cannot keep local viewers from writing to their own rings: {error}");
            });
        }
        Ok(Self { memory, map, layout, next: 0 })
    }

    /// Where things lie.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// What viewers map.
    pub fn descriptor(&self) -> BorrowedFd<'_> {
        self.memory.as_fd()
    }

    /// Writes an envelope and its payload into the slot that was used longest ago. Returns the slot
    /// and its number; none when they do not fit.
    pub fn write(&mut self, envelope: &[u8], payload: &[u8]) -> Option<(u32, u64)> {
        let bytes = envelope.len().checked_add(payload.len())?;
        if bytes as u64 > self.layout.slot_bytes() {
            return None;
        }
        let slot = self.next;
        self.next = (slot + 1) % self.layout.slots();
        let number = self.number(slot);
        // Only this process writes it, and only here.
        let before = u64::from_le(number.load(Ordering::Relaxed));
        number.store((before + 1).to_le(), Ordering::Relaxed);
        // Who sees a byte of what follows sees that the number is odd.
        fence(Ordering::Release);
        // SAFETY: `layout` was made with the memory, so the slot lies inside the map, which is sealed
        // against shrinking; envelope and payload fit into the slot and are memory of this process
        // alone. Readers in other processes tell by the number that they read what changed.
        unsafe {
            let at = self.map.as_mut_ptr().add(self.layout.slot(slot) as usize);
            at.copy_from_nonoverlapping(envelope.as_ptr(), envelope.len());
            at.add(envelope.len()).copy_from_nonoverlapping(payload.as_ptr(), payload.len());
        }
        // Who sees the new number sees all of the payload.
        number.store((before + 2).to_le(), Ordering::Release);
        Some((slot, before + 2))
    }

    /// The sequence number of a slot that is there.
    fn number(&self, slot: u32) -> &AtomicU64 {
        let at = self.layout.sequence(slot) as usize;
        // SAFETY: the number of a slot of `layout` lies inside the map, at a multiple of 64 from a
        // page's start; the map lives as long as `self`, and all access to it is atomic.
        unsafe { AtomicU64::from_ptr(self.map.as_mut_ptr().add(at).cast()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use memmap2::MmapOptions;

    #[test]
    fn viewers_cannot_change_a_ring_or_its_size() {
        let mut ring = Ring::new(Layout::new(2, 4096).unwrap()).unwrap();
        assert_eq!(ring.write(b"head", b"payload"), Some((0, 2)));
        let theirs = ring.memory.try_clone().unwrap();
        for bytes in [0, ring.layout.bytes() - 1, ring.layout.bytes() + 1] {
            assert!(theirs.set_len(bytes).is_err(), "{bytes}");
        }
        assert!(theirs.write_all_at(b"x", 0).is_err());
        assert!(MmapOptions::new().map_raw(&theirs).is_err(), "a shared map to write");
        assert!(fcntl_add_seals(&theirs, SealFlags::WRITE).is_err(), "a seal that keeps the daemon out");
        // Also where the descriptor is opened anew for writing.
        use std::os::fd::AsRawFd as _;
        let path = format!("/proc/self/fd/{}", theirs.as_raw_fd());
        let again = File::options().read(true).write(true).open(path).unwrap();
        assert!(again.write_all_at(b"x", 0).is_err() && again.set_len(0).is_err());
        assert!(MmapOptions::new().map_raw(&again).is_err());
        // What they are meant to do.
        assert!(MmapOptions::new().map_raw_read_only(&theirs).is_ok());
        let mut seen = [0; 11];
        theirs.read_exact_at(&mut seen, ring.layout.slot(0)).unwrap();
        assert_eq!(&seen, b"headpayload");
        // The daemon itself writes on.
        assert_eq!(ring.write(b"", b"more"), Some((1, 2)));
    }

    #[test]
    fn slots_take_turns_and_what_does_not_fit_changes_nothing() {
        let mut ring = Ring::new(Layout::new(3, 4096).unwrap()).unwrap();
        for turn in 1..=3 {
            for slot in 0..3 {
                assert_eq!(ring.write(&[0; 96], &[0; 4000]), Some((slot, 2 * turn)));
                assert_eq!(ring.write(&[0; 97], &[0; 4000]), None);
            }
        }
    }
}
