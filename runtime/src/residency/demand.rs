//! What is wanted: the tiles that frames ask for, or what stands in for them, and all they rest on.

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;

use crate::planet::Planet;

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
        match self.can_come(key) {
            // A tile is decoded from its parent.
            Ok(true) => key.level >= self.planet.grid().root_level() || self.available(key.parent()),
            Ok(false) => {
                self.unavailable.insert(key, Unavailable::Absent);
                false
            }
            Err(error) => {
                self.unavailable.insert(key, Unavailable::Damaged(error));
                false
            }
        }
    }

    /// True for a tile that the file has, or that no finer one touches.
    fn can_come(&self, key: TileKey) -> Result<bool, FormatError> {
        let relief = self.planet.relief();
        relief.check_whole()?;
        if relief.find(key)?.is_some() {
            return Ok(true);
        }
        for finer in closure::within_and_about(self.planet.grid(), key) {
            if relief.find(finer)?.is_some() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(super) fn want_pinned(&mut self) {
        for n in 0..self.pinned.len() {
            self.want(self.pinned[n]);
        }
    }
}

/// The tiles that a file has of its coarsest levels, as long as they are a small part of the slots.
pub(super) fn pinned(planet: &Planet, slots: u32) -> Vec<TileKey> {
    let (grid, relief) = (planet.grid(), planet.relief());
    let (root, mut keys) = (grid.root_level(), Vec::new());
    for level in (root.saturating_sub(PINNED_LEVELS)..=root).rev() {
        // What cannot be read is an error when it is asked for.
        let find = |key| relief.check_whole().and_then(|()| relief.find(key));
        let stored: Vec<TileKey> =
            closure::level(grid, level).filter(|&key| matches!(find(key), Ok(Some(_)))).collect();
        if level < root && (keys.len() + stored.len()) * PINNED_SHARE as usize > slots as usize {
            break;
        }
        keys.extend(stored);
    }
    keys
}
