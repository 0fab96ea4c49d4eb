//! What will be baked: the grid, the step, and which tiles the file will have.

use std::collections::HashSet;

use relief_formats::codec::nodes::SAMPLE_LIMIT;
use relief_formats::file::header::STEP_EXPONENTS;
use relief_formats::grid::{Grid, M_RANGE};
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

use crate::source::{NodeWindow, SourceSet};
use relief_front::error::ToolError;

/// Tiles along a block's side: a block is worked off at once, for [`BLOCK_LEVELS`] levels.
pub const BLOCK_TILES: u32 = 8;
/// Cells along a block's side, at the level where its stage starts.
pub const BLOCK_CELLS: u32 = BLOCK_TILES * TILE_CELLS;
/// Levels of a stage: a block is one tile at the last of them.
pub const BLOCK_LEVELS: u32 = BLOCK_TILES.ilog2() + 1;

/// The grid and the tiles of a bake.
pub struct Plan {
    /// The grid of nodes.
    pub grid: Grid,
    /// Heights are q 2^`step_exponent` metres.
    pub step_exponent: i8,
    /// For each source the finest level it is sampled at.
    pub finest: Vec<u32>,
    /// Every tile is present at every level.
    dense: bool,
    present: HashSet<TileKey>,
}

impl Plan {
    /// Plans a bake of `sources` at map exponent `m` (checked) with steps of 2^`step_exponent` m.
    ///
    /// # Errors
    /// [`ToolError::Usage`] for an m or a step that no file can have.
    pub fn new(sources: &SourceSet, m: Option<u32>, step_exponent: i8) -> Result<Self, ToolError> {
        let chosen = m.unwrap_or_else(|| sources.default_m());
        if !M_RANGE.contains(&chosen) {
            return Err(ToolError::usage(
                format!("m = {chosen}{}", if m.is_none() { " (from the finest source's spacing)" } else { "" }),
                format!("m is {} to {}", M_RANGE.start(), M_RANGE.end()),
                format!("give --m {}", if chosen < *M_RANGE.start() { M_RANGE.start() } else { M_RANGE.end() }),
            ));
        }
        if !STEP_EXPONENTS.contains(&step_exponent) {
            return Err(ToolError::usage(
                format!("a step of 2^{step_exponent} m"),
                format!("a step is 2^{} to 2^{} m", STEP_EXPONENTS.start(), STEP_EXPONENTS.end()),
                "choose another --step or --max-error",
            ));
        }
        let grid = Grid::new(chosen, sources.body.is_plane());
        let own: Vec<u32> = (0..sources.len()).map(|s| sources.finest_level(s, &grid)).collect();
        // An m beyond what the sources need is the user's wish: the finest source then fills level 0.
        let spare = own.iter().copied().min().unwrap_or(0);
        let finest = own.iter().map(|level| (level - spare).min(grid.root_level())).collect();
        let mut plan = Self { grid, step_exponent, finest, dense: false, present: HashSet::new() };
        plan.find_tiles(sources);
        Ok(plan)
    }

    fn find_tiles(&mut self, sources: &SourceSet) {
        let root = self.grid.root_level();
        let mut level_keys: Vec<TileKey> = (0..self.grid.tiles_y(root))
            .flat_map(|y| (0..self.grid.tiles_x(root)).map(move |x| TileKey::new(root, x, y)))
            .collect();
        let mut total = 0u64;
        for level in (0..=root).rev() {
            if level < root {
                level_keys = level_keys
                    .iter()
                    .flat_map(|p| (0..4).map(move |q| TileKey::new(level, 2 * p.x + (q & 1), 2 * p.y + (q >> 1))))
                    .filter(|&key| self.has_source(sources, key))
                    .collect();
            }
            total += level_keys.len() as u64;
            self.present.extend(&level_keys);
        }
        let all: u64 = (0..=root).map(|l| u64::from(self.grid.tiles_x(l)) * u64::from(self.grid.tiles_y(l))).sum();
        self.dense = total == all;
    }

    fn has_source(&self, sources: &SourceSet, key: TileKey) -> bool {
        let window = NodeWindow {
            level: key.level,
            x0: i64::from(key.x * TILE_CELLS),
            y0: i64::from(key.y * TILE_CELLS),
            nx: TILE_NODES,
            ny: TILE_NODES,
        };
        (0..sources.len()).any(|s| self.finest[s] <= key.level && sources.covers(s, &self.grid, &window))
    }

    /// True when every tile of every level is present.
    #[must_use]
    pub fn is_dense(&self) -> bool {
        self.dense
    }

    /// True when the file will have the tile.
    #[must_use]
    pub fn has(&self, key: TileKey) -> bool {
        self.dense || self.present.contains(&key)
    }

    /// Tiles the file will have.
    #[must_use]
    pub fn tile_count(&self) -> usize {
        self.present.len()
    }

    /// True when the level-k tile that owns node (x, y) is absent; indices may run over the seam
    /// and the poles.
    #[must_use]
    pub fn absent(&self, level: u32, x: i32, y: i32) -> bool {
        if self.dense {
            return false;
        }
        let (x, y) = self.grid.home_node(level, x, y);
        let (w, h) = (self.grid.tiles_x(level), self.grid.tiles_y(level));
        let tile = |v: i32, n: u32| (v as u32 / TILE_CELLS).min(n - 1);
        !self.has(TileKey::new(level, tile(x, w), tile(y, h)))
    }

    /// Metres per step.
    #[must_use]
    pub fn step_m(&self) -> f64 {
        f64::from(self.step_exponent).exp2()
    }

    /// A height in steps: rounded to the nearest, at most half a step off.
    ///
    /// # Errors
    /// [`ToolError::Usage`] when the file cannot hold the height with this step.
    pub fn quantize(&self, height_m: f64) -> Result<i32, ToolError> {
        let q = (height_m / self.step_m()).round();
        if q.abs() <= f64::from(SAMPLE_LIMIT) {
            return Ok(q as i32);
        }
        Err(ToolError::usage(
            format!("a height of {height_m} m in steps of {} m", self.step_m()),
            format!("a height is less than 2^23 = {} steps", SAMPLE_LIMIT + 1),
            "choose a larger --step, or name the void value with --nodata",
        ))
    }
}
