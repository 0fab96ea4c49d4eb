//! What is wanted: the tiles that frames ask for, or what stands in for them, and all they rest on.

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;

use super::{Resident, Store, Unavailable, closure};

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

    /// True while what [`Self::want`] would settle for is not here.
    pub(super) fn is_to_come(&self, key: TileKey) -> bool {
        let root = self.planet.grid().root_level();
        let (mut settled, mut above) = (key, key);
        while above.level < root && self.slots.find(above).is_none() {
            if self.unavailable.contains_key(&above) {
                settled = above.parent();
            }
            above = above.parent();
        }
        self.slots.find(settled).is_none()
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
