//! Slots of the atlas: which page lies where, which was used last, which may leave.

use std::collections::{BTreeSet, HashMap};

use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;
use relief_shaders::pages::{USABLE, key as page_key};

use super::closure;
use super::table::Table;

#[derive(Clone, Copy)]
struct Held {
    slot: u32,
    used: u64,
    usable: bool,
}

/// The atlas without its bytes.
///
/// What a page rests on is always used at least as recently as the page, so the least recently
/// used page, the finest among equals, has nothing that rests on it.
pub(super) struct Slots {
    grid: Grid,
    held: HashMap<TileKey, Held>,
    /// (round of the last use, level, page key): the first may leave first.
    order: BTreeSet<(u64, u32, u32)>,
    free: Vec<u32>,
    table: Table,
    round: u64,
}

impl Slots {
    pub fn new(grid: Grid, capacity: u32, table_bits: u32) -> Self {
        Self {
            grid,
            held: HashMap::new(),
            order: BTreeSet::new(),
            free: (0..capacity).rev().collect(),
            table: Table::new(table_bits),
            round: 0,
        }
    }

    pub fn len(&self) -> usize {
        self.held.len()
    }

    pub fn table(&self) -> &[[u32; 2]] {
        self.table.entries()
    }

    pub fn find(&self, key: TileKey) -> Option<u32> {
        self.held.get(&key).map(|held| held.slot)
    }

    /// From now on pages are in use only if they are touched again.
    pub fn next_round(&mut self) {
        self.round += 1;
    }

    /// Marks a page and all it rests on as used in this round; false when it is not here.
    pub fn touch(&mut self, key: TileKey) -> bool {
        let Some(held) = self.held.get_mut(&key) else { return false };
        if held.used < self.round {
            self.order.remove(&order(held.used, key));
            held.used = self.round;
            self.order.insert(order(self.round, key));
            for below in closure::touching(self.grid, key) {
                self.touch(below);
            }
        }
        true
    }

    /// Slots that are free or may become free, counted up to `limit`.
    pub fn room(&self, limit: usize) -> usize {
        let unused = self.order.iter().take(limit).take_while(|(used, ..)| *used < self.round);
        (self.free.len() + unused.count()).min(limit)
    }

    /// Gives a page a slot, with whether another had to leave; none when all are in use.
    ///
    /// The page is usable when all pages that it rests on are here and usable.
    pub fn enter(&mut self, key: TileKey) -> Option<(u32, bool)> {
        if self.touch(key) {
            return Some((self.find(key)?, false));
        }
        let below = closure::touching(self.grid, key);
        for &below in &below {
            self.touch(below);
        }
        let dropped = self.free.is_empty();
        if dropped {
            self.drop_oldest()?;
        }
        let slot = self.free.pop()?;
        let usable = below.iter().all(|below| self.held.get(below).is_some_and(|held| held.usable));
        let word = slot | if usable { USABLE } else { 0 };
        if !self.table.insert(page_key(key.level, key.x, key.y), word) {
            self.free.push(slot);
            return None;
        }
        self.held.insert(key, Held { slot, used: self.round, usable });
        self.order.insert(order(self.round, key));
        Some((slot, dropped))
    }

    fn drop_oldest(&mut self) -> Option<()> {
        let &(used, level, page) = self.order.first().filter(|(used, ..)| *used < self.round)?;
        self.order.remove(&(used, level, page));
        self.table.remove(page);
        let (level, x, y) = relief_shaders::pages::unkey(page);
        let held = self.held.remove(&TileKey::new(level, x, y))?;
        self.free.push(held.slot);
        Some(())
    }
}

fn order(used: u64, key: TileKey) -> (u64, u32, u32) {
    (used, key.level, page_key(key.level, key.x, key.y))
}

#[cfg(test)]
mod tests;
