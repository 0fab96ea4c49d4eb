//! How many pages an atlas holds.

use relief_shaders::pages::{BOUND_WORDS, HEIGHT_WORDS};
use relief_shaders::planet as shared;

use crate::planet::Planet;

/// Bytes of a slot in both of its buffers.
pub const SLOT_BYTES: u64 = 4 * (HEIGHT_WORDS as u64 + BOUND_WORDS as u64);
/// Fewest slots an atlas may have: one place of the finest level and all it rests on.
const FEWEST: u64 = 64;
/// Slots whose words a u32 can still count.
const MOST: u64 = u32::MAX as u64 / HEIGHT_WORDS as u64;

/// Slots of an atlas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    slots: u32,
}

/// An atlas too small to show anything: the caller or the adapter allows too little.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("an atlas of {bytes} bytes: a view needs at least {fewest} tiles of {SLOT_BYTES} bytes", fewest = FEWEST)]
pub struct CapacityError {
    bytes: u64,
}

impl Capacity {
    /// As many slots as fit `atlas_bytes` in all and `binding_bytes` in either buffer.
    ///
    /// # Errors
    /// Less than 64 tiles (29 MB).
    pub fn within(atlas_bytes: u64, binding_bytes: u64) -> Result<Self, CapacityError> {
        let largest = 4 * u64::from(HEIGHT_WORDS.max(BOUND_WORDS));
        let slots = (atlas_bytes / SLOT_BYTES).min(binding_bytes / largest).min(MOST);
        if slots < FEWEST {
            return Err(CapacityError { bytes: atlas_bytes.min(binding_bytes) });
        }
        Ok(Self { slots: slots as u32 })
    }

    #[cfg(test)]
    pub(super) fn of_slots(slots: u32) -> Self {
        Self { slots }
    }

    /// Slots.
    #[must_use]
    pub fn slots(&self) -> u32 {
        self.slots
    }

    /// The page table has 2^bits entries: a quarter full, chains stay short.
    #[must_use]
    pub fn table_bits(&self) -> u32 {
        (4 * self.slots).next_power_of_two().ilog2()
    }

    /// The record of pages asked for has 2^bits entries; it may hold pages beyond the atlas.
    #[must_use]
    pub fn seen_bits(&self) -> u32 {
        self.table_bits().max(12)
    }

    /// What kernels are told of a planet, with the sizes of these tables.
    #[must_use]
    pub fn uniform(&self, planet: &Planet) -> shared::Planet {
        shared::Planet { table_bits: self.table_bits(), seen_bits: self.seen_bits(), ..planet.uniform() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_kept() {
        let capacity = Capacity::within(1 << 30, 128 << 20).unwrap();
        assert_eq!(capacity.slots(), (128 << 20) / (4 * HEIGHT_WORDS));
        assert_eq!((capacity.table_bits(), capacity.seen_bits()), (11, 12));
        assert_eq!(Capacity::within(64 * SLOT_BYTES, 1 << 40).unwrap().slots(), 64);
        assert!(Capacity::within(64 * SLOT_BYTES - 1, 1 << 40).is_err());
        assert!(Capacity::within(1 << 40, 1 << 20).is_err());
        assert_eq!(u64::from(Capacity::within(u64::MAX, u64::MAX).unwrap().slots()), MOST);
    }
}
