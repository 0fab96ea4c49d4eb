//! Pages in memory, as the residency would fill them from a world.

use std::sync::atomic::AtomicU32;

use relief_shaders::pages::{BLOCKS, BOUND_WORDS, HEIGHT_WORDS, NODES, NONE, PROBES, Pages, USABLE, hash, key};
use relief_shaders::planet::Planet;
use relief_shaders::shadow::Relief;

use crate::worlds::{dense, planet};
use relief_shaders::oracle::World;

pub struct PageSet {
    pub planet: Planet,
    pub table: Vec<[u32; 2]>,
    pub heights: Vec<f32>,
    pub bounds: Vec<u32>,
    pub seen: Vec<AtomicU32>,
}

impl PageSet {
    /// Pages of the tiles (level, column, row) that are present.
    pub fn of(world: &World, present: impl Fn(u32, u32, u32) -> bool) -> Self {
        let planet = Planet { table_bits: 10, seen_bits: 10, ..planet(world) };
        let dense = dense(world);
        let mut set = Self {
            planet,
            table: vec![[NONE; 2]; 1 << 10],
            heights: Vec::new(),
            bounds: Vec::new(),
            seen: (0..1 << 10).map(|_| AtomicU32::new(0)).collect(),
        };
        for level in 0..=planet.root_level {
            let (columns, rows) = (dense.columns() as u32 >> level >> 8, dense.rows() as u32 >> level >> 8);
            for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
                if !present(level, x, y) {
                    continue;
                }
                let slot = set.heights.len() as u32 / HEIGHT_WORDS;
                for (row, column) in (0..NODES).flat_map(|row| (0..NODES).map(move |column| (row, column))) {
                    let [i, j] = [256 * x + column, 256 * y + row].map(|v| (v as usize) << level);
                    set.heights.push(dense.row_m(j)[i]);
                }
                for (row, column) in (0..BLOCKS).flat_map(|row| (0..BLOCKS).map(move |column| (row, column))) {
                    let bounds = (&dense).extremes_m(level, BLOCKS * x + column, BLOCKS * y + row).unwrap();
                    set.bounds.extend(bounds.map(f32::to_bits));
                }
                set.bounds.resize(((slot + 1) * BOUND_WORDS) as usize, 0);
                set.insert(key(level, x, y), USABLE | slot);
            }
        }
        set
    }

    fn insert(&mut self, key: u32, word: u32) {
        let start = hash(key, self.planet.table_bits) as usize;
        let length = self.table.len();
        let free = (0..PROBES as usize).map(|k| (start + k) % length).find(|&k| self.table[k][0] == NONE).unwrap();
        self.table[free] = [key, word];
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

    /// Keys asked for since the last call, in order.
    pub fn take_asked(&self) -> Vec<u32> {
        let mut keys: Vec<u32> = self
            .seen
            .iter()
            .map(|cell| cell.swap(0, std::sync::atomic::Ordering::Relaxed))
            .filter(|&key| key != 0)
            .map(|key| key - 1)
            .collect();
        keys.sort_unstable();
        keys
    }
}
