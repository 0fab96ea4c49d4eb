//! The ring: shared memory in which local viewers find their payloads.
//!
//! All little-endian. The head: eight bytes `RLFRING1`, u32 slots, u32 zero, u64 bytes of a slot,
//! u64 offset of the first slot. From byte 64 on a u64 for each slot, 64 bytes apart: its sequence
//! number, odd while it is being written. Slots follow at multiples of 4096 bytes; each holds an
//! envelope ([`crate::payload`]).
//!
//! A viewer that was told of (slot, sequence) reads the number, uses the slot, and reads the number
//! again: if it has changed, the slot was overwritten and what was read is worth nothing. The memory
//! is sealed: nobody can shrink it, and viewers cannot write to it.

/// The first bytes.
pub const MAGIC: [u8; 8] = *b"RLFRING1";
/// Bytes before the sequence numbers that mean something.
pub const HEAD_BYTES: usize = 32;
/// Offset of the first sequence number, and the distance between two.
pub const SEQUENCES: u64 = 64;
/// Multiple of bytes at which slots begin.
const PAGE: u64 = 4096;
/// Most slots.
pub const MOST_SLOTS: u32 = 16;
/// Most bytes of a slot.
pub const MOST_SLOT_BYTES: u64 = 1 << 30;

/// Where things lie in a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    slots: u32,
    slot_bytes: u64,
    first: u64,
}

impl Layout {
    /// A ring with slots of at least so many bytes; none beyond the limits.
    #[must_use]
    pub fn new(slots: u32, slot_bytes: u64) -> Option<Self> {
        let good = (1..=MOST_SLOTS).contains(&slots) && (1..=MOST_SLOT_BYTES).contains(&slot_bytes);
        let first = (SEQUENCES * (1 + u64::from(slots))).next_multiple_of(PAGE);
        good.then(|| Self { slots, slot_bytes: slot_bytes.next_multiple_of(PAGE), first })
    }

    /// What a head says; none where it is no ring's, or the ring does not fit into so many bytes.
    #[must_use]
    pub fn read(head: &[u8; HEAD_BYTES], bytes: u64) -> Option<Self> {
        let (magic, rest) = head.split_first_chunk::<8>()?;
        let (slots, rest) = rest.split_first_chunk::<4>()?;
        let (_, rest) = rest.split_first_chunk::<4>()?;
        let (slot_bytes, rest) = rest.split_first_chunk::<8>()?;
        let first = u64::from_le_bytes(*rest.first_chunk::<8>()?);
        let good = Self::new(u32::from_le_bytes(*slots), u64::from_le_bytes(*slot_bytes))?;
        let layout = Self { slot_bytes: u64::from_le_bytes(*slot_bytes), first, ..good };
        let fits = layout.slot_bytes.is_multiple_of(PAGE)
            && first.is_multiple_of(PAGE)
            && first >= good.first
            && first <= bytes
            && layout.bytes() <= bytes;
        (*magic == MAGIC && fits).then_some(layout)
    }

    /// Slots.
    #[must_use]
    pub fn slots(&self) -> u32 {
        self.slots
    }

    /// Bytes of a slot.
    #[must_use]
    pub fn slot_bytes(&self) -> u64 {
        self.slot_bytes
    }

    /// Bytes of the whole.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.slot(self.slots)
    }

    /// Offset of a slot's sequence number.
    #[must_use]
    pub fn sequence(&self, slot: u32) -> u64 {
        SEQUENCES * (1 + u64::from(slot))
    }

    /// Offset of a slot.
    #[must_use]
    pub fn slot(&self, slot: u32) -> u64 {
        self.first + u64::from(slot) * self.slot_bytes
    }

    /// The bytes before the sequence numbers.
    #[must_use]
    pub fn head(&self) -> [u8; HEAD_BYTES] {
        let mut out = [0; HEAD_BYTES];
        out[..8].copy_from_slice(&MAGIC);
        out[8..12].copy_from_slice(&self.slots.to_le_bytes());
        out[16..24].copy_from_slice(&self.slot_bytes.to_le_bytes());
        out[24..32].copy_from_slice(&self.slot(0).to_le_bytes());
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_overlaps() {
        for slots in 1..=MOST_SLOTS {
            let layout = Layout::new(slots, 5000).unwrap();
            assert!(layout.head().len() as u64 <= layout.sequence(0));
            assert!(layout.sequence(slots - 1) + 8 <= layout.slot(0));
            assert!((0..slots).all(|k| layout.slot(k).is_multiple_of(4096)));
            assert_eq!(layout.bytes(), layout.slot(slots - 1) + layout.slot_bytes());
            assert_eq!(Layout::read(&layout.head(), layout.bytes()), Some(layout));
        }
        assert_eq!(Layout::new(0, 1), None);
        assert_eq!(Layout::new(17, 1), None);
        assert_eq!(Layout::new(4, u64::MAX), None);
    }

    #[test]
    fn heads_of_no_ring_are_refused() {
        let layout = Layout::new(4, 5000).unwrap();
        let bent = |at: usize, value: u8| {
            let mut head = layout.head();
            head[at] = value;
            Layout::read(&head, layout.bytes())
        };
        assert_eq!(bent(12, 9), Some(layout), "a field that may be used later");
        // The magic, no slots, too many, a slot that is no page, huge ones, an offset inside the numbers, far away.
        for (at, value) in [(0, b'r'), (8, 0), (8, 17), (8, 5), (16, 1), (20, 1), (25, 0), (24, 1), (31, 255)] {
            assert_eq!(bent(at, value), None, "{at} {value}");
        }
        assert_eq!(Layout::read(&layout.head(), layout.bytes() - 1), None);
    }
}
