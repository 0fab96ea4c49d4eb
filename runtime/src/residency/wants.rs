//! Pages that are wanted, coarsest first.

use std::collections::BTreeSet;

use relief_formats::tile::TileKey;

/// A set in the order of loading: [`TileKey`]'s own, coarsest level first.
#[derive(Default)]
pub(super) struct Wants(BTreeSet<TileKey>);

impl Wants {
    /// True when the page was not wanted yet.
    pub fn insert(&mut self, key: TileKey) -> bool {
        self.0.insert(key)
    }

    pub fn remove(&mut self, key: TileKey) {
        self.0.remove(&key);
    }

    pub fn contains(&self, key: TileKey) -> bool {
        self.0.contains(&key)
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn iter(&self) -> impl Iterator<Item = TileKey> + '_ {
        self.0.iter().copied()
    }
}
