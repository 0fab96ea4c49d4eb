//! Filtered means, H_ext and deviations built again from the nodes of the finest tiles, and
//! compared with what the file holds.
//!
//! The map is worked off in blocks of 8 x 8 tiles for four levels at a time; what lies below the
//! next four is summarised block by block, so that memory does not grow with the map but for
//! those summaries.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use relief_formats::codec::hext;
use relief_formats::derive::crown::{crown, lay};
use relief_formats::derive::extremes::Extremes;
use relief_formats::derive::{Absent, Base, Block, Field, LevelPlanes, Window, derive_block, padding};
use relief_formats::file::FormatError;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

use super::check::Check;
use super::compare::Compare;
use super::finding::Findings;
use super::map::Map;
use super::summary::Summaries;

/// Tiles along a block's side, at the level where its stage starts.
const BLOCK_TILES: u32 = 8;
/// Cells along a block's side, at that level.
const BLOCK_CELLS: u32 = BLOCK_TILES * TILE_CELLS;
/// Levels of a stage: a block is one tile at the last of them.
const STAGE_LEVELS: u32 = 4;
/// What deriving one block of the first stage and of a later one takes, measured and rounded up.
const BLOCK_BYTES: [u64; 2] = [160 << 20, 380 << 20];

/// What a summary holds for each cell of its level.
const SUMMARY_BYTES: u64 = 40;

/// Compares all tiles; `step` is called with the number of tiles done.
///
/// # Errors
/// A tile that does not decode.
pub(super) fn derived(
    map: &Map<'_>,
    memory_bytes: u64,
    findings: &Findings,
    step: impl Fn(u64) + Sync,
) -> Result<(), FormatError> {
    let root = map.grid.root_level();
    let mut summaries: Option<Summaries<'_>> = None;
    let mut first = 0;
    while first <= root {
        let (compare, roots) = (Compare { map, findings }, Mutex::default());
        let stage = Stage { map, compare, roots, first, levels: STAGE_LEVELS.min(root + 1 - first) };
        let block_bytes = BLOCK_BYTES[usize::from(first > 0)];
        // A quarter of the memory is the tile cache's.
        let free =
            (memory_bytes / 4 * 3).saturating_sub(summaries.as_ref().map_or(0, Summaries::cells) * SUMMARY_BYTES);
        let at_once = (free / block_bytes).clamp(1, rayon::current_num_threads() as u64) as usize;
        let mut next = HashMap::new();
        for chunk in stage.blocks().chunks(at_once) {
            let done = chunk.par_iter().map(|&at| {
                let summary = stage.block(at, summaries.as_ref(), &step)?;
                Ok((at, Arc::new(summary)))
            });
            next.extend(done.collect::<Result<Vec<_>, FormatError>>()?);
        }
        first += stage.levels;
        if first > root {
            return stage.crown(&next);
        }
        summaries = Some(Summaries::new(map, first, (BLOCK_CELLS >> stage.levels) as i32, next));
    }
    Ok(())
}

struct Stage<'a> {
    map: &'a Map<'a>,
    compare: Compare<'a>,
    /// The root level's tiles' deviations, but for the crown's.
    roots: Mutex<Vec<(TileKey, Field<u8>)>>,
    /// Level where it starts.
    first: u32,
    levels: u32,
}

impl Stage<'_> {
    /// Compares the root level's deviations, with those of the levels above it.
    fn crown(self, parts: &HashMap<(i32, i32), Arc<Base>>) -> Result<(), FormatError> {
        let parts: Vec<&Base> = parts.values().map(|base| &**base).collect();
        let codes = crown(self.map.grid, &parts);
        for (key, mut built) in self.roots.into_inner().unwrap_or_else(PoisonError::into_inner) {
            lay(&codes, &mut built);
            self.compare.deviations(key, &built)?;
        }
        Ok(())
    }

    /// Blocks with a tile: those present at the stage's last level, or the whole map at its end.
    fn blocks(&self) -> Vec<(i32, i32)> {
        let grid = &self.map.grid;
        let last = self.first + self.levels - 1;
        let columns = grid.width(self.first).div_ceil(BLOCK_CELLS);
        let rows = grid.height(self.first).div_ceil(BLOCK_CELLS);
        let all = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let present = all.filter(|&(x, y)| last == grid.root_level() || self.map.has(TileKey::new(last, x, y)));
        present.map(|(x, y)| (x as i32, y as i32)).collect()
    }

    /// Derives a block, compares its tiles, and returns its summary.
    fn block(
        &self,
        (x, y): (i32, i32),
        summaries: Option<&Summaries<'_>>,
        step: &(impl Fn(u64) + Sync),
    ) -> Result<Base, FormatError> {
        let (w, h) = self.map.size(self.first);
        let side = BLOCK_CELLS as i32;
        let core = Window::new(x * side, y * side, side.min(w) as usize, side.min(h) as usize);
        let pad = padding(self.levels);
        let base = match summaries {
            Some(summaries) => summaries.gather(core, pad)?,
            None => Base {
                level: self.first,
                nodes: self.map.nodes(self.first, core.expand(pad).nodes())?,
                mip: None,
                below: None,
            },
        };
        let absent = |level: u32, x: i32, y: i32| self.map.absent(level, x, y);
        let absent: Option<&Absent<'_>> = if self.map.is_dense() { None } else { Some(&absent) };
        let Block { levels, next } = derive_block(base, core, self.levels, absent);
        levels.par_iter().try_for_each(|planes| {
            let size = (TILE_CELLS << (planes.level - self.first)) as i32;
            let tiles = (core.y0 / size..core.y1() / size)
                .flat_map(|y| (core.x0 / size..core.x1() / size).map(move |x| (x, y)));
            let keys: Vec<_> = tiles
                .map(|(x, y)| TileKey::new(planes.level, x as u32, y as u32))
                .filter(|&key| self.map.has(key))
                .collect();
            keys.into_par_iter().try_for_each(|key| {
                self.tile(key, planes)?;
                step(1);
                Ok::<_, FormatError>(())
            })
        })?;
        Ok(next)
    }

    fn tile(&self, key: TileKey, planes: &LevelPlanes) -> Result<(), FormatError> {
        let cells = TILE_CELLS as i32;
        let half = cells as usize / 2;
        let (x0, y0) = (key.x as i32 * cells, key.y as i32 * cells);
        let nodes = Window::new(x0, y0, TILE_NODES, TILE_NODES);
        if let Some(mip) = &planes.mip {
            let (built, stored) = (mip.crop(nodes), self.map.tiles.mip(key)?);
            self.compare.samples(Check::Mip, key, 1, built.data(), &stored, |built, stored| {
                (stored != built).then(|| format!("{stored} steps, must be {built}"))
            });
        }
        let truth = planes.extremes.crop(Window::new(x0 / 2, y0 / 2, half, half));
        let stored = self.map.tiles.extremes(key)?;
        let words = |how: &str, stored: &Extremes, other: &Extremes| {
            format!("bounds {} to {} steps {how} {} to {}", stored.min, stored.max, other.min, other.max)
        };
        let inside = self.compare.samples(Check::HextInside, key, 2, truth.data(), &stored, |truth, stored| {
            (stored.min > truth.min || stored.max < truth.max).then(|| words("inside S_0's", stored, truth))
        });
        if !inside {
            let (_, tight) = hext::encode(truth.data(), &self.map.tiles.nodes(key)?);
            self.compare.samples(Check::HextLoose, key, 2, &tight, &stored, |tight, stored| {
                (stored != tight).then(|| words("where these would do:", stored, tight))
            });
        }
        let built = planes.deviations.crop(nodes);
        if key.level == self.map.grid.root_level() {
            // Its even nodes' codes need the whole map.
            self.roots.lock().unwrap_or_else(PoisonError::into_inner).push((key, built));
            return Ok(());
        }
        self.compare.deviations(key, &built)
    }
}
