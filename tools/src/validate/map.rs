//! A file's tiles as one map: which are there, and nodes across tile borders, seam and poles.

use std::collections::{HashMap, HashSet};

use relief_formats::derive::{Field, Window};
use relief_formats::file::{FormatError, Relief};
use relief_formats::grid::Grid;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

const CELLS: i32 = TILE_CELLS as i32;

/// The map of a file whose structure and checksums are good.
pub(super) struct Map<'a> {
    pub relief: &'a Relief,
    pub tiles: &'a Tiles<'a>,
    pub grid: Grid,
    /// The tiles there are; `None` when there are all.
    present: Option<HashSet<TileKey>>,
}

impl<'a> Map<'a> {
    /// # Errors
    /// An index entry that cannot be.
    pub fn new(relief: &'a Relief, tiles: &'a Tiles<'a>) -> Result<Self, FormatError> {
        let grid = relief.grid();
        let all: u64 =
            (0..=grid.root_level()).map(|level| u64::from(grid.tiles_x(level)) * u64::from(grid.tiles_y(level))).sum();
        let dense = relief.tile_count() as u64 == all;
        let present = if dense {
            None
        } else {
            Some(relief.entries().map(|entry| Ok(entry?.key)).collect::<Result<_, FormatError>>()?)
        };
        Ok(Self { relief, tiles, grid, present })
    }

    /// True when all tiles of all levels are present.
    pub fn is_dense(&self) -> bool {
        self.present.is_none()
    }

    /// True when the tile is present.
    pub fn has(&self, key: TileKey) -> bool {
        self.present.as_ref().is_none_or(|present| present.contains(&key))
    }

    /// Cells of a level: columns and rows.
    pub fn size(&self, level: u32) -> (i32, i32) {
        (self.grid.width(level) as i32, self.grid.height(level) as i32)
    }

    /// The tile that owns a node of the map: the one to its north-east, but at the last row (and
    /// a plane's last column).
    fn owner(&self, level: u32, (x, y): (i32, i32)) -> TileKey {
        let tile = |v: i32, count: u32| ((v / CELLS) as u32).min(count - 1);
        TileKey::new(level, tile(x, self.grid.tiles_x(level)), tile(y, self.grid.tiles_y(level)))
    }

    /// True when the tile that owns node (x, y), which may lie beyond the map, is absent.
    pub fn absent(&self, level: u32, x: i32, y: i32) -> bool {
        self.present.is_some() && !self.has(self.owner(level, self.grid.home_node(level, x, y)))
    }

    /// Nodes of a window that may reach beyond the map.
    ///
    /// # Errors
    /// A tile that does not decode.
    pub fn nodes(&self, level: u32, window: Window) -> Result<Field<i32>, FormatError> {
        let (w, _) = self.size(level);
        let mut held = HashMap::new();
        let mut field = Field::new(window);
        for (y, out) in (window.y0..).zip(field.data_mut().chunks_exact_mut(window.nx.max(1))) {
            let mut x = window.x0;
            while x < window.x1() {
                let home = self.grid.home_node(level, x, y);
                let key = self.owner(level, home);
                let samples = match held.get(&key) {
                    Some(samples) => samples,
                    None => held.entry(key).or_insert(self.tiles.nodes(key)?),
                };
                let (i, j) = ((home.0 - key.x as i32 * CELLS) as usize, (home.1 - key.y as i32 * CELLS) as usize);
                // Beyond a plane's edge one node stands for all.
                let run = if self.grid.plane && !(0..w).contains(&x) { 1 } else { CELLS as usize - i };
                let run = run.min((window.x1() - x) as usize);
                out[(x - window.x0) as usize..][..run].copy_from_slice(&samples[j * TILE_NODES + i..][..run]);
                x += run as i32;
            }
        }
        Ok(field)
    }
}
