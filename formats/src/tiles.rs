//! Decoded tiles: single tiles on any thread, with the chain of coarser tiles they need.

use std::sync::Arc;

use quick_cache::{Weighter, sync::Cache};

use crate::codec::{CodecError, deviation, filled, hext, mip, nodes};
use crate::derive::extremes::Extremes;
use crate::file::index::{Digest, digest};
use crate::file::{Entry, FormatError, Plane, Relief};
use crate::tile::{TILE_NODES, TileKey};
use crate::tile_planes::{hext_bytes, little_endian};

/// Samples of one plane of a tile, 257 x 257, in steps, south row first.
pub type Samples = Arc<Vec<i32>>;

const TILE_BYTES: u64 = (TILE_NODES * TILE_NODES * size_of::<i32>()) as u64;

/// A file's tiles, decoded on demand and kept within a budget. Shared by any number of threads.
pub struct Tiles<'a> {
    relief: File<'a>,
    cache: Cache<(TileKey, Plane), Samples, OneTile>,
    verify: bool,
}

enum File<'a> {
    Borrowed(&'a Relief),
    Shared(Arc<Relief>),
}

#[derive(Clone)]
struct OneTile;

impl Weighter<(TileKey, Plane), Samples> for OneTile {
    fn weight(&self, _: &(TileKey, Plane), _: &Samples) -> u64 {
        TILE_BYTES
    }
}

impl Tiles<'static> {
    /// [`Tiles::new`] for a file that has other owners too.
    #[must_use]
    pub fn shared(relief: Arc<Relief>, cache_bytes: u64) -> Self {
        Self::over(File::Shared(relief), cache_bytes)
    }
}

impl<'a> Tiles<'a> {
    /// Tiles of a file, keeping up to `cache_bytes` of decoded samples. Every decoded plane is
    /// checked against its digest.
    #[must_use]
    pub fn new(relief: &'a Relief, cache_bytes: u64) -> Self {
        Self::over(File::Borrowed(relief), cache_bytes)
    }

    /// Tiles of a file for reading all of a level once, row by row of its tiles, on so many threads:
    /// room for the coarser tiles that a row is decoded from, and no more.
    #[must_use]
    pub fn for_level(relief: &'a Relief, level: u32, threads: usize) -> Self {
        let grid = relief.grid();
        let coarser: u64 = (level + 1..=grid.root_level()).map(|k| u64::from(grid.tiles_x(k))).sum();
        // Nodes and means of each; two rows share theirs.
        let planes = 2 * coarser.max(1) * threads.max(1).div_ceil(2) as u64;
        Self::holding(File::Borrowed(relief), planes * TILE_BYTES)
    }

    fn over(relief: File<'a>, cache_bytes: u64) -> Self {
        Self::holding(relief, cache_bytes.max(64 * TILE_BYTES))
    }

    fn holding(relief: File<'a>, capacity: u64) -> Self {
        let cache = Cache::with_weighter((capacity / TILE_BYTES) as usize, capacity, OneTile);
        Self { relief, cache, verify: true }
    }

    /// Bytes of decoded samples that may be kept.
    #[must_use]
    pub fn cache_bytes(&self) -> u64 {
        self.cache.capacity()
    }

    /// Leaves the digests unchecked: for files that were validated.
    #[must_use]
    pub fn trusting(mut self) -> Self {
        self.verify = false;
        self
    }

    /// The file.
    #[must_use]
    pub fn relief(&self) -> &Relief {
        match &self.relief {
            File::Borrowed(relief) => relief,
            File::Shared(relief) => relief,
        }
    }

    /// How often a decoded plane was at hand, and how often it was not.
    #[must_use]
    pub fn hits_and_misses(&self) -> [u64; 2] {
        [self.cache.hits(), self.cache.misses()]
    }

    /// Heights of S_0 at a tile's nodes; between the coarser level's where the tile is absent.
    pub fn nodes(&self, key: TileKey) -> Result<Samples, FormatError> {
        self.cache.get_or_insert_with(&(key, Plane::Nodes), || self.decode_nodes(key).map(Arc::new))
    }

    /// [`Tiles::nodes`] for a reader who comes by each tile once: they are not kept.
    pub fn nodes_once(&self, key: TileKey) -> Result<Samples, FormatError> {
        match self.cache.get(&(key, Plane::Nodes)) {
            Some(samples) => Ok(samples),
            None => self.decode_nodes(key).map(Arc::new),
        }
    }

    /// Filtered means at a tile's nodes; at level 0 the nodes themselves.
    pub fn mip(&self, key: TileKey) -> Result<Samples, FormatError> {
        if key.level == 0 {
            return self.nodes(key);
        }
        self.cache.get_or_insert_with(&(key, Plane::Mip), || self.decode_mip(key).map(Arc::new))
    }

    /// Bounds of S_0 over the tile's 2 x 2 cells, 128 x 128.
    pub fn extremes(&self, key: TileKey) -> Result<Vec<Extremes>, FormatError> {
        let samples = self.nodes(key)?;
        let Some(entry) = self.relief().find(key)? else { return Ok(hext::of_nodes(&samples)) };
        let bounds = hext::decode(self.relief().plane_bytes(&entry, Plane::Hext), &samples);
        self.checked(&entry, Plane::Hext, bounds, |b| digest(&hext_bytes(b)))
    }

    /// Deviation codes of the tile's new nodes, 257 x 257, see [`crate::derive::decode_deviation`]; 0 at
    /// the others, but at the root level codes of the levels above. None for an absent tile: nothing
    /// is stored for it.
    pub fn deviations(&self, key: TileKey) -> Result<Option<Vec<u8>>, FormatError> {
        let Some(entry) = self.relief().find(key)? else { return Ok(None) };
        let samples = self.nodes(key)?;
        let root = key.level == self.relief().grid().root_level();
        let codes = deviation::decode(self.relief().plane_bytes(&entry, Plane::Deviation), &samples, root);
        self.checked(&entry, Plane::Deviation, codes, |c| digest(c)).map(Some)
    }

    /// Which of a tile's nodes are filled; between nodes of which one is filled, an absent tile's
    /// are too.
    pub fn filled(&self, key: TileKey) -> Result<Vec<bool>, FormatError> {
        if let Some(entry) = self.relief().find(key)? {
            let bits = filled::decode(self.relief().plane_bytes(&entry, Plane::Filled));
            return self.checked(&entry, Plane::Filled, bits, |b| digest(&filled::pack(b)));
        }
        let parent = self.filled(self.parent(key)?)?;
        let (x0, y0) = (key.quadrant().0 * nodes::HALF, key.quadrant().1 * nodes::HALF);
        let at = |x: usize, y: usize| parent[(y0 + y) * TILE_NODES + x0 + x];
        Ok((0..TILE_NODES * TILE_NODES)
            .map(|k| {
                let (x, y) = (k % TILE_NODES, k / TILE_NODES);
                let (w, e, s, n) = (x / 2, x.div_ceil(2), y / 2, y.div_ceil(2));
                at(w, s) || at(e, s) || at(w, n) || at(e, n)
            })
            .collect())
    }

    fn parent(&self, key: TileKey) -> Result<TileKey, FormatError> {
        if key.level < self.relief().grid().root_level() {
            Ok(key.parent())
        } else {
            Err(FormatError::damaged("a tile of the coarsest level is missing"))
        }
    }

    fn decode_nodes(&self, key: TileKey) -> Result<Vec<i32>, FormatError> {
        let entry = self.relief().find(key)?;
        if key.level == self.relief().grid().root_level() {
            let entry = entry.ok_or_else(|| FormatError::damaged("a tile of the coarsest level is missing"))?;
            let samples = nodes::decode_root(self.relief().plane_bytes(&entry, Plane::Nodes));
            return self.checked_samples(&entry, Plane::Nodes, samples);
        }
        let parent = self.parent(key)?;
        let even = nodes::quarter(&self.nodes(parent)?, key.quadrant());
        let Some(entry) = entry else { return Ok(nodes::interpolate(&even, nodes::HALF)) };
        let mean = match key.level {
            0 => Some(nodes::quarter(&self.mip(parent)?, key.quadrant())),
            _ => None,
        };
        let samples = nodes::decode(self.relief().plane_bytes(&entry, Plane::Nodes), &even, mean.as_deref());
        self.checked_samples(&entry, Plane::Nodes, samples)
    }

    fn decode_mip(&self, key: TileKey) -> Result<Vec<i32>, FormatError> {
        let root = key.level == self.relief().grid().root_level();
        let mean = match root {
            true => None,
            false => Some(nodes::quarter(&self.mip(self.parent(key)?)?, key.quadrant())),
        };
        let Some(entry) = self.relief().find(key)? else {
            let mean = mean.ok_or_else(|| FormatError::damaged("a tile of the coarsest level is missing"))?;
            return Ok(nodes::interpolate(&mean, nodes::HALF));
        };
        let samples = self.nodes(key)?;
        let means = mip::decode(self.relief().plane_bytes(&entry, Plane::Mip), &samples, mean.as_deref());
        self.checked_samples(&entry, Plane::Mip, means)
    }

    fn checked_samples(
        &self,
        entry: &Entry,
        plane: Plane,
        samples: Result<Vec<i32>, CodecError>,
    ) -> Result<Vec<i32>, FormatError> {
        self.checked(entry, plane, samples, |s| digest(bytemuck::cast_slice(&little_endian(s))))
    }

    fn checked<T>(
        &self,
        entry: &Entry,
        plane: Plane,
        samples: Result<T, CodecError>,
        digest_of: impl Fn(&T) -> Digest,
    ) -> Result<T, FormatError> {
        let fail = |error| FormatError::Tile { key: entry.key, plane: plane.name(), error };
        let samples = samples.map_err(fail)?;
        if self.verify && digest_of(&samples) != entry.digests[plane as usize] {
            return Err(fail(CodecError::Digest));
        }
        Ok(samples)
    }
}
