//! The page table as the kernels read it: open addressing, linear probing, no tombstones.

use relief_shaders::pages::{NONE, PROBES, hash};

/// Entries (key, page word); an empty one is ([`NONE`], [`NONE`]).
pub(super) struct Table {
    entries: Vec<[u32; 2]>,
    bits: u32,
}

impl Table {
    pub fn new(bits: u32) -> Self {
        Self { entries: vec![[NONE; 2]; 1 << bits], bits }
    }

    pub fn entries(&self) -> &[[u32; 2]] {
        &self.entries
    }

    /// Sets a key's word; false when its chain would be longer than kernels look.
    #[must_use]
    pub fn insert(&mut self, key: u32, word: u32) -> bool {
        let mut at = hash(key, self.bits) as usize;
        for _ in 0..PROBES {
            let entry = &mut self.entries[at];
            if entry[0] == NONE || entry[0] == key {
                *entry = [key, word];
                return true;
            }
            at = self.next(at);
        }
        false
    }

    /// Removes a key and closes the gap it leaves in its chain.
    pub fn remove(&mut self, key: u32) {
        let mut gap = hash(key, self.bits) as usize;
        while self.entries[gap][0] != key {
            if self.entries[gap][0] == NONE {
                return;
            }
            gap = self.next(gap);
        }
        let mut at = self.next(gap);
        while self.entries[at][0] != NONE {
            // An entry may move into the gap when its chain starts at or before it.
            let home = hash(self.entries[at][0], self.bits) as usize;
            if self.distance(home, at) >= self.distance(gap, at) {
                self.entries[gap] = self.entries[at];
                gap = at;
            }
            at = self.next(at);
        }
        self.entries[gap] = [NONE; 2];
    }

    fn next(&self, at: usize) -> usize {
        (at + 1) & (self.entries.len() - 1)
    }

    fn distance(&self, from: usize, to: usize) -> usize {
        to.wrapping_sub(from) & (self.entries.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;
    use relief_shaders::pages::{Pages, unkey};
    use relief_shaders::planet::Planet;

    use super::*;

    proptest! {
        /// Against a map, asked through the kernels' twin.
        #[test]
        fn kernels_find_what_a_map_finds(steps in prop::collection::vec((any::<bool>(), 0u32..40), 0..300)) {
            let bits = 6;
            let mut table = Table::new(bits);
            let mut map = HashMap::new();
            // Keys a few of which share a home.
            let key = |k: u32| (k % 8) << 25 | k;
            for (insert, k) in steps {
                let key = key(k);
                if insert {
                    if table.insert(key, k + 1) {
                        map.insert(key, k + 1);
                    }
                } else {
                    table.remove(key);
                    map.remove(&key);
                }
            }
            let planet = Planet { table_bits: bits, ..Planet::default() };
            let pages = Pages { planet: &planet, table: table.entries(), heights: &[], bounds: &[], seen: &[] };
            for k in 0..40 {
                let (level, x, y) = unkey(key(k));
                prop_assert_eq!(pages.find(level, x, y), map.get(&key(k)).copied().unwrap_or(NONE));
            }
        }
    }

    #[test]
    fn a_chain_ends_where_kernels_stop() {
        let mut table = Table::new(10);
        let crowded: Vec<u32> = (0..u32::MAX).filter(|&k| hash(k, 10) == 1023).take(PROBES as usize + 1).collect();
        for &key in &crowded[..PROBES as usize] {
            assert!(table.insert(key, 1));
        }
        assert!(!table.insert(crowded[PROBES as usize], 1));
        table.remove(crowded[3]);
        assert!(table.insert(crowded[PROBES as usize], 1));
    }
}
