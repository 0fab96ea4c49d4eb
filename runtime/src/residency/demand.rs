//! What is wanted: the tiles that frames ask for, or what stands in for them, and all they rest on.

use relief_formats::tile::TileKey;

use super::{Resident, Store, Unavailable, closure};

/// Tiles of the coarsest levels that are never dropped: at most this share of the slots.
const PINNED_SHARE: u32 = 4;
/// Levels below the root that are never dropped.
const PINNED_LEVELS: u32 = 2;

impl<S: Store> Resident<S> {
    /// Marks the finest tile at or above `key` that the file can give, with what it rests on, as
    /// used and wanted. True when a page lacks.
    pub(super) fn want(&mut self, mut key: TileKey) -> bool {
        if self.slots.touch(key) {
            return false;
        }
        let root = self.planet.grid().root_level();
        while !self.available(key) {
            if key.level >= root {
                return false;
            }
            key = key.parent();
        }
        if self.slots.touch(key) {
            return false;
        }
        if self.wants.insert(key) {
            for below in closure::touching(self.planet.grid(), key) {
                self.want(below);
            }
        }
        true
    }

    pub(super) fn available(&mut self, key: TileKey) -> bool {
        if self.slots.find(key).is_some() {
            return true;
        }
        if self.unavailable.contains_key(&key) {
            return false;
        }
        let relief = self.planet.relief();
        match relief.check_whole().and_then(|()| relief.find(key)) {
            // A tile is decoded from its parent.
            Ok(Some(_)) => key.level >= self.planet.grid().root_level() || self.available(key.parent()),
            Ok(None) => {
                self.unavailable.insert(key, Unavailable::Absent);
                false
            }
            Err(error) => {
                self.unavailable.insert(key, Unavailable::Damaged(error));
                false
            }
        }
    }

    pub(super) fn want_pinned(&mut self) {
        let grid = self.planet.grid();
        let root = grid.root_level();
        let mut tiles = 0;
        for level in (root.saturating_sub(PINNED_LEVELS)..=root).rev() {
            tiles += grid.tiles_x(level) * grid.tiles_y(level);
            if level == root || tiles * PINNED_SHARE <= self.slots.capacity() {
                closure::level(grid, level).for_each(|key| {
                    self.want(key);
                });
            }
        }
    }
}
