//! What enters: wanted tiles decoded by the workers, each after all it rests on.

use relief_formats::tile::TileKey;

use super::{Page, Progress, Resident, Store, closure};

impl<S: Store> Resident<S> {
    /// Keeps the workers busy with what can find room.
    pub(super) fn dispatch(&mut self) {
        let busy = self.loader.in_flight() + self.ready.len();
        let room = self.slots.room(self.loader.limit()).saturating_sub(busy);
        let start = room.min(self.loader.limit().saturating_sub(busy));
        let next: Vec<TileKey> = self
            .wants
            .iter()
            .filter(|key| !self.loader.is_loading(*key) && !self.ready.contains_key(key))
            .take(start)
            .collect();
        next.into_iter().for_each(|key| self.loader.start(key));
    }

    /// Lets decoded pages enter, coarsest first.
    pub(super) fn enter_ready(&mut self, progress: &mut Progress) {
        self.ready.retain(|&key, _| self.wants.contains(key));
        while let Some(&key) = self.ready.keys().find(|&&key| self.rests(key)) {
            let Some(page) = self.ready.remove(&key) else { break };
            let Some(dropped) = self.enter(key, &page) else {
                self.ready.insert(key, page);
                break;
            };
            progress.loaded += 1;
            progress.dropped += dropped;
        }
    }

    /// True when no page that `key` rests on is still to come.
    pub(super) fn rests(&self, key: TileKey) -> bool {
        closure::touching(self.planet.grid(), key).into_iter().all(|below| !self.wants.contains(below))
    }

    /// Puts a page into a slot; how many pages had to leave, or none when there is no room.
    pub(super) fn enter(&mut self, key: TileKey, page: &Page) -> Option<usize> {
        let (slot, dropped) = self.slots.enter(key)?;
        self.store.write_page(slot, page);
        self.wants.remove(key);
        Some(usize::from(dropped))
    }
}
