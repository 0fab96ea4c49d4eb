//! The atlas in RAM, for the kernels' twins.

use std::sync::atomic::{AtomicU32, Ordering};

use relief_shaders::pages::{BOUND_WORDS, HEIGHT_WORDS, Pages};

use super::{Capacity, Page, Resident, Store};

/// Slots and tables in RAM.
pub struct Ram {
    heights: Vec<f32>,
    bounds: Vec<u32>,
    seen: Vec<AtomicU32>,
}

impl Ram {
    /// An empty atlas; its pages of memory are taken when they are written.
    #[must_use]
    pub fn new(capacity: Capacity) -> Self {
        let words = |of: u32| capacity.slots() as usize * of as usize;
        Self {
            heights: vec![0.0; words(HEIGHT_WORDS)],
            bounds: vec![0; words(BOUND_WORDS)],
            seen: (0..1 << capacity.seen_bits()).map(|_| AtomicU32::new(0)).collect(),
        }
    }
}

impl Store for Ram {
    fn write_page(&mut self, slot: u32, page: &Page) {
        put(&mut self.heights, slot, &page.heights);
        put(&mut self.bounds, slot, &page.bounds);
    }

    fn write_table(&mut self, _: &[[u32; 2]]) {}
}

fn put<T: Copy>(buffer: &mut [T], slot: u32, part: &[T]) {
    buffer[slot as usize * part.len()..][..part.len()].copy_from_slice(part);
}

impl Resident<Ram> {
    /// The pages as the twins read them.
    #[must_use]
    pub fn pages(&self) -> Pages<'_> {
        let ram = self.store();
        Pages {
            planet: self.uniform(),
            table: self.table(),
            heights: &ram.heights,
            bounds: &ram.bounds,
            seen: &ram.seen,
        }
    }

    /// Takes the record of the pages that twins asked for and hands it to [`Resident::ask`].
    pub fn ask_seen(&mut self) -> usize {
        let seen = &self.store().seen;
        let keys: Vec<u32> = seen.iter().filter_map(|cell| cell.swap(0, Ordering::Relaxed).checked_sub(1)).collect();
        self.ask(keys)
    }
}
