//! Pages in memory, as the residency would hold them; the tests of each kernel fill them.

use std::sync::atomic::AtomicU32;

use relief_shaders::pages::{HEIGHT_WORDS, NONE, PROBES, Pages, hash};
use relief_shaders::planet::Planet;

pub struct PageSet {
    pub planet: Planet,
    pub table: Vec<[u32; 2]>,
    pub heights: Vec<f32>,
    pub bounds: Vec<u32>,
    pub seen: Vec<AtomicU32>,
}

impl PageSet {
    /// No pages of a planet.
    pub fn empty(planet: Planet) -> Self {
        Self {
            planet: Planet { table_bits: 10, seen_bits: 10, ..planet },
            table: vec![[NONE; 2]; 1 << 10],
            heights: Vec::new(),
            bounds: Vec::new(),
            seen: (0..1 << 10).map(|_| AtomicU32::new(0)).collect(),
        }
    }

    /// Slots whose heights are filled.
    pub fn slots(&self) -> u32 {
        self.heights.len() as u32 / HEIGHT_WORDS
    }

    pub fn insert(&mut self, key: u32, word: u32) {
        let start = hash(key, self.planet.table_bits) as usize;
        let length = self.table.len();
        let free = (0..PROBES as usize).map(|k| (start + k) % length).find(|&k| self.table[k][0] == NONE);
        self.table[free.expect("the table is too small")] = [key, word];
    }

    pub fn pages(&self) -> Pages<'_> {
        Pages {
            planet: &self.planet,
            table: &self.table,
            heights: &self.heights,
            bounds: &self.bounds,
            seen: &self.seen,
        }
    }
}
