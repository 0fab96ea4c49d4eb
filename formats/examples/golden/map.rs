//! A small map held whole: its nodes, what follows from them, and its tiles.

use std::collections::BTreeSet;
use std::error::Error;

use relief_formats::codec::nodes::{HALF, interpolate};
use relief_formats::derive::crown::{crown, lay};
use relief_formats::derive::extremes::Extremes;
use relief_formats::derive::{Base, Field, LevelPlanes, Window, derive_block, padding};
use relief_formats::file::Relief;
use relief_formats::grid::Grid;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tile_planes::{EncodedTile, TileSamples, encode};
use relief_formats::tiles::Tiles;

use crate::terrain::{Kind, filled, height_q};

/// Nodes of level 0 and which tiles a file will have.
pub struct Map {
    grid: Grid,
    present: BTreeSet<TileKey>,
    columns: usize,
    nodes: Vec<i32>,
}

impl Map {
    /// A map without the tiles `absent` names (nor, of course, those below them).
    pub fn new(grid: Grid, kind: Kind, absent: impl Fn(TileKey) -> bool) -> Self {
        let mut present = BTreeSet::new();
        for level in (0..=grid.root_level()).rev() {
            for y in 0..grid.tiles_y(level) {
                for x in 0..grid.tiles_x(level) {
                    let key = TileKey::new(level, x, y);
                    let root = level == grid.root_level();
                    if root || (!absent(key) && present.contains(&key.parent())) {
                        present.insert(key);
                    }
                }
            }
        }
        let (columns, rows) = (grid.width(0), grid.height(0) + u32::from(!grid.plane));
        let nodes = (0..rows).flat_map(|j| (0..columns).map(move |i| height_q(grid, kind, i, j))).collect();
        let mut map = Self { grid, present, columns: columns as usize, nodes };
        map.interpolate_absent();
        map
    }

    /// Puts what a reader sees into absent tiles, edges included: a present neighbour shares them.
    fn interpolate_absent(&mut self) {
        for level in (0..self.grid.root_level()).rev() {
            for y in 0..self.grid.tiles_y(level) {
                for x in 0..self.grid.tiles_x(level) {
                    let key = TileKey::new(level, x, y);
                    if self.present.contains(&key) {
                        continue;
                    }
                    let even: Vec<i32> = (0..=HALF as i32)
                        .flat_map(|r| (0..=HALF as i32).map(move |c| (2 * c, 2 * r)))
                        .map(|(c, r)| self.node(level, corner(x) + c, corner(y) + r))
                        .collect();
                    for (k, q) in interpolate(&even, HALF).into_iter().enumerate() {
                        let (c, r) = ((k % TILE_NODES) as i32, (k / TILE_NODES) as i32);
                        let at = self.place(level, corner(x) + c, corner(y) + r);
                        self.nodes[at] = q;
                    }
                }
            }
        }
    }

    /// Column and row of level 0 that stand for node (i, j) of a level, wherever that lies.
    fn fold(&self, level: u32, i: i32, j: i32) -> (u32, u32) {
        let (width, height) = (self.grid.width(0) as i32, self.grid.height(0) as i32);
        let (mut i, mut j) = (i << level, j << level);
        if self.grid.plane {
            let mirror = |v: i32, far: i32| v.abs().min(2 * far - v.abs()).min(far - 1) as u32;
            return (mirror(i, width), mirror(j, height));
        }
        if j < 0 || j > height {
            (i, j) = (i + width / 2, if j < 0 { -j } else { 2 * height - j });
        }
        (i.rem_euclid(width) as u32, j as u32)
    }

    fn place(&self, level: u32, i: i32, j: i32) -> usize {
        let (i, j) = self.fold(level, i, j);
        j as usize * self.columns + i as usize
    }

    /// Height of any node of a level, in steps.
    pub fn node(&self, level: u32, i: i32, j: i32) -> i32 {
        self.nodes[self.place(level, i, j)]
    }

    fn is_absent(&self, level: u32, i: i32, j: i32) -> bool {
        let (i, j) = self.fold(level, i, j);
        let tile = |index: u32, tiles: u32| ((index >> level) / TILE_CELLS).min(tiles - 1);
        let key = TileKey::new(level, tile(i, self.grid.tiles_x(level)), tile(j, self.grid.tiles_y(level)));
        !self.present.contains(&key)
    }

    /// Every tile of the map, encoded, coarsest level first.
    pub fn tiles(&self) -> Vec<EncodedTile> {
        let levels = self.grid.root_level() + 1;
        let core = Window::new(0, 0, self.grid.width(0) as usize, self.grid.height(0) as usize);
        let nodes = Field::from_fn(core.expand(padding(levels)).nodes(), |i, j| self.node(0, i, j));
        let base = Base { level: 0, nodes, mip: None, below: None };
        let mut block = derive_block(base, core, levels, Some(&|k, i, j| self.is_absent(k, i, j)));
        let codes = crown(self.grid, &[&block.next]);
        if let Some(root) = block.levels.last_mut() {
            lay(&codes, &mut root.deviations);
        }
        self.present.iter().map(|&key| self.tile(key, &block.levels)).collect()
    }

    /// Compares the nodes of every tile that a file has or has not with the map.
    pub fn compare(&self, relief: &Relief) -> Result<(), Box<dyn Error>> {
        let tiles = Tiles::new(relief, 0);
        for level in 0..=self.grid.root_level() {
            for (y, x) in (0..self.grid.tiles_y(level)).flat_map(|y| (0..self.grid.tiles_x(level)).map(move |x| (y, x)))
            {
                let nodes = tiles.nodes(TileKey::new(level, x, y))?;
                let at = |k: usize| (corner(x) + (k % TILE_NODES) as i32, corner(y) + (k / TILE_NODES) as i32);
                if let Some(k) = (0..nodes.len()).find(|&k| nodes[k] != self.node(level, at(k).0, at(k).1)) {
                    return Err(format!("level {level}: node {:?} differs", at(k)).into());
                }
            }
        }
        Ok(())
    }

    fn tile(&self, key: TileKey, planes: &[LevelPlanes]) -> EncodedTile {
        let level = &planes[key.level as usize];
        let (x0, y0) = (corner(key.x), corner(key.y));
        let window = Window::new(x0, y0, TILE_NODES, TILE_NODES);
        let quarter = Window::new(x0 / 2, y0 / 2, HALF + 1, HALF + 1);
        let root = key.level == self.grid.root_level();
        let mip = |level: usize, window: Window| Some(planes.get(level)?.mip.as_ref()?.crop(window).into_data());
        let means = if root { None } else { mip(key.level as usize + 1, quarter) };
        let extremes: Vec<Extremes> = level.extremes.crop(Window::new(x0 / 2, y0 / 2, HALF, HALF)).into_data();
        let filled: Vec<bool> = (0..TILE_NODES * TILE_NODES)
            .map(|k| self.fold(key.level, x0 + (k % TILE_NODES) as i32, y0 + (k / TILE_NODES) as i32))
            .map(|(i, j)| filled(self.grid, i, j))
            .collect();
        encode(&TileSamples {
            key,
            root,
            nodes: level.nodes.crop(window).data(),
            mip: &mip(key.level as usize, window).unwrap_or_default(),
            parent_mean: means.as_deref(),
            extremes: &extremes,
            deviations: level.deviations.crop(window).data(),
            filled: &filled,
        })
    }
}

const fn corner(tile: u32) -> i32 {
    (tile * TILE_CELLS) as i32
}
