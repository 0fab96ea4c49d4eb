//! Which tiles are at hand: wanted by the frames, decoded in the background, kept in the slots of
//! an atlas until others need the room (paper 002's pages, paper 003's time budget).
//!
//! The kernels record the pages they ask for; [`Resident::ask`] takes that record, marks what is
//! there as used and queues what is not; [`Resident::update`] loads within a time budget. A page
//! enters only after all pages of the next coarser level that touch it, and leaves only before
//! them: so wherever a kernel finds a page, it finds what stands in for its neighbours too.
//!
//! A tile that a sparse file lacks becomes a page like any other, with interpolated nodes and codes
//! made for them: only so do flat triangles follow S_0 between coarse nodes, and the ellipsoid.

mod capacity;
mod closure;
mod demand;
mod lacking;
mod loader;
mod page;
mod pinned;
mod ram;
mod slots;
mod supply;
mod table;
mod wants;

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;
use relief_shaders::pages;
use relief_shaders::planet as shared;

use crate::planet::Planet;
use loader::Loader;
use slots::Slots;
use wants::Wants;

pub use capacity::{Capacity, CapacityError};
pub use page::Page;
pub use ram::Ram;

/// Where pages are put: a GPU's buffers or RAM.
pub trait Store {
    /// Fills a slot.
    fn write_page(&mut self, slot: u32, page: &Page);
    /// Replaces the page table.
    fn write_table(&mut self, table: &[[u32; 2]]);
}

/// What an update did, and what is still to come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Pages that entered the atlas.
    pub loaded: usize,
    /// Pages that left it.
    pub dropped: usize,
    /// Pages that are wanted and not there.
    pub missing: usize,
    /// Pages in the atlas.
    pub resident: usize,
    /// True when all slots are in use: what is missing will not come.
    pub full: bool,
}

/// Why a tile never enters.
enum Unavailable {
    /// The file has no such tile but finer ones that touch it, against its format's rules: a
    /// coarser one holds its heights.
    Absent,
    /// Its bytes, or those of a tile it is decoded from.
    Damaged(FormatError),
}

/// A set of pages in a store, shared by any number of views.
pub struct Resident<S> {
    planet: Arc<Planet>,
    uniform: shared::Planet,
    slots: Slots,
    store: S,
    loader: Loader,
    wants: Wants,
    unavailable: HashMap<TileKey, Unavailable>,
    /// Decoded pages that wait for a coarser one.
    ready: BTreeMap<TileKey, Page>,
    /// Tiles that are always wanted.
    pinned: Vec<TileKey>,
    /// Pages that the last frame asked for and lacked, as kernels name them.
    lacked: Vec<u32>,
    /// Tiles that the last frame asked for and that coarser ones stand in for.
    stood_in_for: Vec<TileKey>,
    /// The pages asked for belong to a new round when an update came in between.
    updated: bool,
}

impl<S: Store> Resident<S> {
    /// A resident set over an empty store; the coarsest tiles are loaded at once.
    ///
    /// # Errors
    /// A damaged tile of the coarsest level: without it nothing can be shown.
    pub fn new(planet: Arc<Planet>, capacity: Capacity, store: S) -> Result<Self, FormatError> {
        let grid = planet.grid();
        let uniform = capacity.uniform(&planet);
        let mut resident = Self {
            slots: Slots::new(grid, capacity.slots(), capacity.table_bits()),
            loader: Loader::new(Arc::clone(&planet)),
            wants: Wants::default(),
            unavailable: HashMap::new(),
            ready: BTreeMap::new(),
            pinned: pinned::tiles(&planet, capacity.slots()),
            lacked: Vec::new(),
            stood_in_for: Vec::new(),
            updated: true,
            planet,
            uniform,
            store,
        };
        let root = grid.root_level();
        for key in closure::level(grid, root) {
            let page = resident.loader.decode(key)?;
            resident.enter(key, &page);
        }
        resident.store.write_table(resident.slots.table());
        resident.want_pinned();
        Ok(resident)
    }

    /// The planet.
    #[must_use]
    pub fn planet(&self) -> &Arc<Planet> {
        &self.planet
    }

    /// What the kernels are told of the planet and of this set's tables.
    #[must_use]
    pub fn uniform(&self) -> &shared::Planet {
        &self.uniform
    }

    /// The store.
    #[must_use]
    pub fn store(&self) -> &S {
        &self.store
    }

    /// The store, for the frames that are drawn from it.
    pub fn store_mut(&mut self) -> &mut S {
        &mut self.store
    }

    /// Pages in the atlas.
    #[must_use]
    pub fn count(&self) -> usize {
        self.slots.len()
    }

    /// The entries of the page table.
    #[must_use]
    pub fn table(&self) -> &[[u32; 2]] {
        self.slots.table()
    }

    /// Takes the pages that a frame asked for (`seen` entries less one; see
    /// `relief_shaders::pages`): what is there counts as used, what is not is wanted. Returns how
    /// many pages the frame lacked.
    ///
    /// Pages asked for between two updates are all in use, whichever view asked.
    pub fn ask(&mut self, keys: impl IntoIterator<Item = u32>) -> usize {
        if std::mem::take(&mut self.updated) {
            self.slots.next_round();
            self.wants.clear();
            self.want_pinned();
        }
        self.lacked.clear();
        self.stood_in_for.clear();
        for key in keys {
            let tile = tile_of(key);
            if !self.planet.grid().contains(tile) {
                continue;
            }
            if self.want(tile) {
                self.lacked.push(key);
            } else if self.slots.find(tile).is_none() {
                self.stood_in_for.push(tile);
            }
        }
        self.lacked.len()
    }

    /// The pages that the last [`Self::ask`] lacked. A host with views that it does not draw in every
    /// round asks for them again, so that they stay wanted.
    #[must_use]
    pub fn lacked(&self) -> &[u32] {
        &self.lacked
    }

    /// How many of these pages, which were asked for, are still to come.
    #[must_use]
    pub fn still_lacks(&self, keys: &[u32]) -> usize {
        keys.iter().filter(|&&key| self.is_to_come(tile_of(key))).count()
    }

    /// Loads what is wanted, until nothing is left or the time is over. A single page may overrun
    /// the budget; pages that are being decoded meanwhile enter with the next update.
    ///
    /// Waits for worker threads of the global `rayon` pool, so it must not be called from one.
    pub fn update(&mut self, budget: Duration) -> Progress {
        let deadline = Instant::now() + budget;
        self.updated = true;
        let mut progress = Progress::default();
        self.enter_ready(&mut progress);
        loop {
            self.dispatch();
            let left = deadline.saturating_duration_since(Instant::now());
            let Some((key, page)) = self.loader.receive(left) else { break };
            match page {
                Ok(page) => {
                    self.ready.insert(key, page);
                }
                Err(error) => {
                    self.unavailable.insert(key, Unavailable::Damaged(error));
                    self.wants.remove(key);
                }
            }
            self.enter_ready(&mut progress);
        }
        if progress.loaded > 0 {
            self.store.write_table(self.slots.table());
        }
        progress.missing = self.wants.len();
        progress.resident = self.slots.len();
        progress.full = progress.missing > 0 && self.loader.idle();
        progress
    }

    /// Tiles that were asked for and cannot be read, with the reason.
    pub fn damaged(&self) -> impl Iterator<Item = (TileKey, &FormatError)> {
        self.unavailable.iter().filter_map(|(&key, why)| match why {
            Unavailable::Damaged(error) => Some((key, error)),
            Unavailable::Absent => None,
        })
    }

    /// Damage that the last [`Self::ask`] met: a tile that was asked for and cannot be read, or not
    /// for want of a coarser one, and the reason. A coarser one stood in for it.
    #[must_use]
    pub fn damage_met(&self) -> Option<(TileKey, &FormatError)> {
        let root = self.planet.grid().root_level();
        self.stood_in_for.iter().find_map(|&asked| {
            let above = std::iter::successors(Some(asked), |tile| (tile.level < root).then(|| tile.parent()));
            above.into_iter().find_map(|tile| match self.unavailable.get(&tile)? {
                Unavailable::Damaged(error) => Some((tile, error)),
                Unavailable::Absent => None,
            })
        })
    }
}

fn tile_of(key: u32) -> TileKey {
    let (level, x, y) = pages::unkey(key);
    TileKey::new(level, x, y)
}

#[cfg(test)]
mod tests;
