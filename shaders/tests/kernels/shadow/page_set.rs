//! Pages filled from a world.

use std::sync::atomic::Ordering;

use relief_shaders::oracle::World;
use relief_shaders::pages::{BLOCKS, BOUND_WORDS, NODES, USABLE, key};
use relief_shaders::shadow::Relief as _;

use super::worlds::{dense, planet};
use crate::page_set::PageSet;

impl PageSet {
    /// Pages of the tiles (level, column, row) that are present.
    pub fn of_world(world: &World, present: impl Fn(u32, u32, u32) -> bool) -> Self {
        let dense = dense(world);
        let mut set = Self::empty(planet(world));
        for level in 0..=set.planet.root_level {
            let (columns, rows) = (dense.columns() as u32 >> level >> 8, dense.rows() as u32 >> level >> 8);
            for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
                if !present(level, x, y) {
                    continue;
                }
                let slot = set.slots();
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

    /// Keys asked for since the last call, in order.
    pub fn take_asked(&self) -> Vec<u32> {
        let mut keys: Vec<u32> = self
            .seen
            .iter()
            .map(|cell| cell.swap(0, Ordering::Relaxed))
            .filter(|&key| key != 0)
            .map(|key| key - 1)
            .collect();
        keys.sort_unstable();
        keys
    }
}
