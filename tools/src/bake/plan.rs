//! What will be baked: the grid, the step, and which tiles the file will have.

use std::cell::Cell;
use std::collections::{BTreeSet, HashSet};

use relief_formats::codec::nodes::SAMPLE_LIMIT;
use relief_formats::file::header::STEP_EXPONENTS;
use relief_formats::grid::{Grid, M_RANGE};
use relief_formats::tile::{TILE_CELLS, TileKey};

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
        let every = (0..self.grid.tiles_y(root)).flat_map(|y| (0..self.grid.tiles_x(root)).map(move |x| (x, y)));
        let mut levels: Vec<BTreeSet<TileKey>> = vec![every.map(|(x, y)| TileKey::new(root, x, y)).collect()];
        for level in (0..root).rev() {
            let parents = levels.last().into_iter().flatten();
            let quadrants =
                parents.flat_map(|p| (0..4).map(move |q| TileKey::new(level, 2 * p.x + (q & 1), 2 * p.y + (q >> 1))));
            let keys = quadrants.filter(|&key| self.has_source(sources, key)).collect();
            levels.push(keys);
        }
        balance(&self.grid, &mut levels);
        self.present = levels.into_iter().flatten().collect();
        let all: usize = (0..=root).map(|l| self.grid.tiles_x(l) as usize * self.grid.tiles_y(l) as usize).sum();
        self.dense = self.present.len() == all;
    }

    fn has_source(&self, sources: &SourceSet, key: TileKey) -> bool {
        let window = NodeWindow::of_tile(key);
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

    /// [`Plan::absent`] for nodes asked for row by row: it remembers the last row of a tile.
    pub fn absent_by_row(&self) -> impl Fn(u32, i32, i32) -> bool + '_ {
        let last = Cell::new((0, 0, 0..0, false));
        move |level, x, y| {
            let (last_level, last_y, columns, absent) = last.take();
            let known = level == last_level && y == last_y && columns.contains(&x);
            let (columns, absent) = if known {
                (columns, absent)
            } else {
                // A globe's columns turn by whole tiles; a plane's are mirrored at its ends.
                let from = x.div_euclid(TILE_CELLS as i32) * TILE_CELLS as i32;
                let whole = !self.grid.plane || (0..self.grid.width(level) as i32).contains(&x);
                (if whole { from..from + TILE_CELLS as i32 } else { x..x + 1 }, self.absent(level, x, y))
            };
            last.set((level, y, columns, absent));
            absent
        }
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

/// Adds the tiles that a tile needs around it, `levels` having the root's tiles first: all tiles of
/// the level above that its area touches, its edges and corners included. Across the edge of a tile
/// the levels then differ by one at most, and a mesh can close it.
fn balance(grid: &Grid, levels: &mut [BTreeSet<TileKey>]) {
    for at in (1..levels.len()).rev() {
        let (above, here) = levels.split_at_mut(at);
        let touched = here[0].iter().flat_map(|&key| touched_above(grid, key));
        above[at - 1].extend(touched);
    }
}

/// The tiles of the level above whose areas meet a tile's: its parent and up to three more.
fn touched_above(grid: &Grid, key: TileKey) -> impl Iterator<Item = TileKey> {
    let level = key.level + 1;
    let (columns, rows) = (grid.tiles_x(level) as i32, grid.tiles_y(level) as i32);
    // A quadrant's outer edges lie on its parent's.
    let outer = |v: u32| (v >> 1) as i32 + if v & 1 == 0 { -1 } else { 1 };
    let (xs, ys) = ([(key.x >> 1) as i32, outer(key.x)], [(key.y >> 1) as i32, outer(key.y)]);
    let wraps = !grid.plane;
    ys.into_iter()
        .filter(move |y| (0..rows).contains(y))
        .flat_map(move |y| xs.map(|x| (x, y)))
        .filter(move |(x, _)| wraps || (0..columns).contains(x))
        .map(move |(x, y)| TileKey::new(level, x.rem_euclid(columns) as u32, y as u32))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;

    fn above(grid: &Grid, level: u32, x: u32, y: u32) -> Vec<(u32, u32)> {
        let mut found: Vec<_> = touched_above(grid, TileKey::new(level, x, y)).map(|key| (key.x, key.y)).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    #[test]
    fn a_tile_touches_its_parent_and_three_more() {
        let globe = Grid::new(11, false);
        assert_eq!(above(&globe, 0, 5, 3), [(2, 1), (2, 2), (3, 1), (3, 2)]);
        assert_eq!(above(&globe, 0, 0, 4), [(0, 1), (0, 2), (7, 1), (7, 2)]);
        assert_eq!(above(&globe, 0, 15, 0), [(0, 0), (7, 0)]);
        assert_eq!(above(&globe, 2, 3, 1), [(0, 0), (1, 0)]);
        let plane = Grid::new(11, true);
        assert_eq!(above(&plane, 0, 0, 7), [(0, 3)]);
        assert_eq!(above(&plane, 1, 1, 1), [(0, 0), (0, 1), (1, 0), (1, 1)]);
    }

    /// One tile at the seam of a deep map, against the rule as it is written: areas that meet.
    #[test]
    fn levels_differ_by_one_where_areas_meet() {
        let grid = Grid::new(14, false);
        let root = grid.root_level();
        let lone = TileKey::new(0, grid.tiles_x(0) - 1, 21);
        let mut levels: Vec<BTreeSet<TileKey>> = (0..=root)
            .rev()
            .map(|level| BTreeSet::from([TileKey::new(level, lone.x >> level, lone.y >> level)]))
            .collect();
        balance(&grid, &mut levels);
        let meet = |a: TileKey, b: TileKey| {
            let span = |key: TileKey, v: u32| (i64::from(v) << key.level, i64::from(v + 1) << key.level);
            let near = |a: (i64, i64), b: (i64, i64), turn: i64| a.0 <= b.1 + turn && b.0 + turn <= a.1;
            let turn = i64::from(grid.tiles_x(0));
            let (x, y) = ((span(a, a.x), span(b, b.x)), (span(a, a.y), span(b, b.y)));
            [-turn, 0, turn].iter().any(|&turn| near(x.0, x.1, turn)) && near(y.0, y.1, 0)
        };
        for pair in levels.windows(2) {
            let level = pair[0].iter().next().unwrap().level;
            let all = (0..grid.tiles_y(level)).flat_map(|y| (0..grid.tiles_x(level)).map(move |x| (x, y)));
            let wanted = all.map(|(x, y)| TileKey::new(level, x, y)).filter(|&a| pair[1].iter().any(|&b| meet(a, b)));
            assert_eq!(pair[0], wanted.collect::<BTreeSet<_>>(), "level {level}");
        }
        assert_eq!(levels[root as usize - 1].len(), 4);
    }
}
