//! One block of one stage: from padded nodes to encoded tiles and a summary.

use rayon::prelude::*;
use relief_formats::derive::{Absent, Base, Field, Window, derive_block};
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tile_planes::{EncodedTile, TileSamples, encode};

use super::handoff::Handoff;
use super::plan::{BLOCK_CELLS, BLOCK_LEVELS, Plan};

/// A block of a stage that starts at `level`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BlockKey {
    /// Level where the stage starts.
    pub level: u32,
    /// Column of blocks.
    pub x: u32,
    /// Row of blocks.
    pub y: u32,
}

/// What became of a block.
pub struct Finished {
    /// Its tiles.
    pub tiles: Vec<EncodedTile>,
    /// Its summary.
    pub handoff: Handoff,
    /// True when some node of its tiles is measured.
    pub measured: bool,
}

impl BlockKey {
    /// The block's cells at its level.
    #[must_use]
    pub fn core(&self, plan: &Plan) -> Window {
        let (w, h) = (plan.grid.width(self.level), plan.grid.height(self.level));
        Window::new(
            (self.x * BLOCK_CELLS) as i32,
            (self.y * BLOCK_CELLS) as i32,
            BLOCK_CELLS.min(w) as usize,
            BLOCK_CELLS.min(h) as usize,
        )
    }

    /// Levels of the stage.
    #[must_use]
    pub fn levels(&self, plan: &Plan) -> u32 {
        BLOCK_LEVELS.min(plan.grid.root_level() - self.level + 1)
    }

    /// The present tiles of the block, all levels of the stage.
    #[must_use]
    pub fn tiles(&self, plan: &Plan) -> Vec<TileKey> {
        let core = self.core(plan);
        (0..self.levels(plan))
            .flat_map(|index| {
                let size = TILE_CELLS << index;
                let (x0, y0) = (core.x0 as u32 / size, core.y0 as u32 / size);
                let (nx, ny) = (core.nx as u32 / size, core.ny as u32 / size);
                let level = self.level + index;
                (0..ny).flat_map(move |y| (0..nx).map(move |x| TileKey::new(level, x0 + x, y0 + y)))
            })
            .filter(|&key| plan.has(key))
            .collect()
    }
}

/// All blocks of a stage that have a tile, in rows from the south.
#[must_use]
pub fn blocks(plan: &Plan, level: u32) -> Vec<BlockKey> {
    let (nx, ny) = (plan.grid.width(level).div_ceil(BLOCK_CELLS), plan.grid.height(level).div_ceil(BLOCK_CELLS));
    let last = (level + BLOCK_LEVELS - 1).min(plan.grid.root_level());
    (0..ny)
        .flat_map(|y| (0..nx).map(move |x| BlockKey { level, x, y }))
        .filter(|key| {
            // A block is one tile of the stage's last level, or the whole map is in one block.
            last == plan.grid.root_level() || plan.has(TileKey::new(last, key.x, key.y))
        })
        .collect()
}

/// Derives all planes of a block and encodes its tiles in parallel.
#[must_use]
pub fn finish(plan: &Plan, key: BlockKey, base: Base, filled: Field<bool>) -> Finished {
    let core = key.core(plan);
    let levels = key.levels(plan);
    let absent = |level: u32, x: i32, y: i32| plan.absent(level, x, y);
    let absent: Option<&Absent<'_>> = if plan.is_dense() { None } else { Some(&absent) };
    let block = derive_block(base, core, levels, absent);
    let mut filled_levels = vec![filled];
    for index in 0..levels as usize {
        let next = filled_levels[index].decimate();
        filled_levels.push(next);
    }
    let root = plan.grid.root_level();
    let encode_one = |tile: TileKey| {
        let index = (tile.level - key.level) as usize;
        let planes = &block.levels[index];
        let cells = Window::new(
            (tile.x * TILE_CELLS) as i32,
            (tile.y * TILE_CELLS) as i32,
            TILE_CELLS as usize,
            TILE_CELLS as usize,
        );
        let nodes = planes.nodes.crop(cells.nodes());
        let mip = planes.mip.as_ref().map(|mip| mip.crop(cells.nodes()));
        let half = Window::new(cells.x0 >> 1, cells.y0 >> 1, cells.nx / 2, cells.ny / 2);
        let parent = block.levels.get(index + 1).map_or(block.next.mip.as_ref(), |p| p.mip.as_ref());
        let mean = parent.filter(|_| tile.level < root).map(|mip| mip.crop(half.nodes()));
        let filled = filled_levels[index].crop(cells.nodes());
        let extremes = planes.extremes.crop(half);
        let deviations = planes.deviations.crop(cells.nodes());
        debug_assert_eq!(nodes.data().len(), TILE_NODES * TILE_NODES);
        encode(&TileSamples {
            key: tile,
            root: tile.level == root,
            nodes: nodes.data(),
            mip: mip.as_ref().map_or(nodes.data(), Field::data),
            parent_mean: mean.as_ref().map(Field::data),
            extremes: extremes.data(),
            deviations: deviations.data(),
            filled: filled.data(),
        })
    };
    let tiles: Vec<EncodedTile> = key.tiles(plan).into_par_iter().map(encode_one).collect();
    let measured = filled_levels[0].crop(core.nodes()).data().contains(&false);
    let top = Window::new(core.x0 >> levels, core.y0 >> levels, core.nx >> levels, core.ny >> levels);
    let handoff = Handoff { base: block.next, filled: filled_levels[levels as usize].crop(top.nodes()) };
    Finished { tiles, handoff, measured }
}
