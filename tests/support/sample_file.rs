//! Small files with heights from a formula, for tests: what they hold is known at every node.

use std::path::Path;

use relief_formats::body::Body;
use relief_formats::codec::nodes::{HALF, quarter};
use relief_formats::derive::crown::{crown, lay};
use relief_formats::derive::{Base, Field, LevelPlanes, Window, derive_block, padding};
use relief_formats::file::writer::{FileSpec, write};
use relief_formats::file::{Entry, Metadata};
use relief_formats::grid::Grid;
use relief_formats::mesh::{MeshLayout, encode_section, patch_mesh};
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tile_planes::{EncodedTile, TileSamples, encode};

/// Height in steps of node (i, j) of level 0: waves with a little noise, one height at each pole.
pub fn wavy_q(grid: Grid, i: u32, j: u32) -> i32 {
    let (width, height) = (grid.width(0), grid.height(0));
    let i = i % width;
    match j {
        0 if !grid.plane => -2835,
        j if j == height && !grid.plane => 4228,
        _ => {
            let (x, y) = (f64::from(i) / f64::from(width), f64::from(j) / f64::from(height));
            let waves =
                (x * 18.0).sin() * 3000.0 * (y * std::f64::consts::PI).sin() + (x * 41.0 + y * 77.0).cos() * 900.0;
            let noise = (i.wrapping_mul(0x9e37_79b1) ^ j.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35) >> 26;
            waves as i32 + noise as i32
        }
    }
}

/// What a file of [`Sample::write`] holds.
pub struct Sample {
    pub body: Body,
    pub m: u32,
    pub step_exponent: i8,
    pub fill: &'static str,
    /// Height in steps of node (i, j) of level 0.
    pub q: fn(Grid, u32, u32) -> i32,
    /// True for filled nodes of level 0.
    pub filled: fn(u32, u32) -> bool,
    /// True for tiles that are left out; their heights are then interpolated by readers.
    pub absent: fn(TileKey) -> bool,
}

impl Sample {
    pub fn new(body: Body, m: u32) -> Self {
        Self { body, m, step_exponent: -4, fill: "none", q: wavy_q, filled: |_, _| false, absent: |_| false }
    }

    /// Writes the file.
    pub fn write(&self, path: &Path) {
        let grid = Grid::new(self.m, self.body.is_plane());
        let levels = grid.root_level() + 1;
        let core = Window::new(0, 0, grid.width(0) as usize, grid.height(0) as usize);
        let nodes = Field::from_fn(core.expand(padding(levels)).nodes(), |x, y| {
            let (i, j) = on_map(grid, x, y);
            (self.q)(grid, i, j)
        });
        let base = Base { level: 0, mip: None, nodes, below: None };
        let absent = |k: u32, x: i32, y: i32| {
            let (i, j) = on_map(grid, x << k, y << k);
            let j = j.min(grid.height(0) - 1);
            (self.absent)(TileKey::new(k, (i >> k) / TILE_CELLS, (j >> k) / TILE_CELLS))
        };
        let mut block = derive_block(base, core, levels, Some(&absent));
        let codes = crown(grid, &[&block.next]);
        if let Some(root) = block.levels.last_mut() {
            lay(&codes, &mut root.deviations);
        }
        let planes = block.levels;
        let tiles: Vec<EncodedTile> = planes.iter().flat_map(|level| self.tiles(grid, &planes, level)).collect();
        let metadata = Metadata {
            body: self.body.clone(),
            vertical: "as given".into(),
            sources: vec![serde_json::json!({ "file": "formula" })],
            resampling: "none".into(),
            fill: self.fill.into(),
            bound_m: f64::from(self.step_exponent).exp2() / 2.0,
            versions: [("test".to_owned(), "1".to_owned())].into(),
        };
        let mesh = encode_section(&patch_mesh(&self.body, &grid, MeshLayout::Aligned));
        let entries: Vec<Entry> = tiles
            .iter()
            .map(|tile| Entry {
                key: tile.key,
                offset: 0,
                lengths: std::array::from_fn(|k| tile.planes[k].len() as u32),
                min_q: tile.min_q,
                max_q: tile.max_q,
                digests: tile.digests,
            })
            .collect();
        let (far_i, far_j) = on_map(grid, core.x1(), core.y1());
        let spec = FileSpec {
            body: &self.body,
            m: self.m,
            step_exponent: self.step_exponent,
            south_pole_q: (self.q)(grid, 0, 0),
            north_pole_q: (self.q)(grid, far_i, far_j),
            metadata: &metadata,
            mesh: &mesh,
        };
        write(path, &spec, &entries, |k, out| {
            out.extend(tiles[k].planes.concat());
            Ok(())
        })
        .unwrap();
    }

    fn tiles(&self, grid: Grid, planes: &[LevelPlanes], level: &LevelPlanes) -> Vec<EncodedTile> {
        let k = level.level;
        let keys = (0..grid.tiles_y(k)).flat_map(|y| (0..grid.tiles_x(k)).map(move |x| TileKey::new(k, x, y)));
        let side = TILE_CELLS as i32;
        let window = |key: TileKey| Window::new(key.x as i32 * side, key.y as i32 * side, TILE_NODES, TILE_NODES);
        keys.filter(|&key| !(self.absent)(key))
            .map(|key| {
                let nodes = window(key);
                let half = Window::new(nodes.x0 / 2, nodes.y0 / 2, HALF, HALF);
                let means = |level: &LevelPlanes, at| level.mip.as_ref().unwrap_or(&level.nodes).crop(at);
                let parent_mean = planes
                    .get(k as usize + 1)
                    .map(|parent| quarter(means(parent, window(key.parent())).data(), key.quadrant()));
                let filled: Vec<bool> = (nodes.y0..nodes.y1())
                    .flat_map(|y| (nodes.x0..nodes.x1()).map(move |x| on_map(grid, x << k, y << k)))
                    .map(|(i, j)| (self.filled)(i, j))
                    .collect();
                encode(&TileSamples {
                    key,
                    root: k == grid.root_level(),
                    nodes: level.nodes.crop(nodes).data(),
                    mip: means(level, nodes).data(),
                    parent_mean: parent_mean.as_deref(),
                    extremes: level.extremes.crop(half).data(),
                    deviations: level.deviations.crop(nodes).data(),
                    filled: &filled,
                })
            })
            .collect()
    }
}

/// The node of the map that a padded index stands for: wrapped at the seam, mirrored over the
/// poles; a plane is mirrored at its edges, where node W is node W - 1 again.
fn on_map(grid: Grid, x: i32, y: i32) -> (u32, u32) {
    let (width, height) = (grid.width(0) as i32, grid.height(0) as i32);
    if grid.plane {
        let mirrored = |v: i32, end: i32| (end - (end - v.abs()).abs()).min(end - 1) as u32;
        return (mirrored(x, width), mirrored(y, height));
    }
    let (x, y) = match y {
        y if y < 0 => (x + width / 2, -y),
        y if y > height => (x + width / 2, 2 * height - y),
        _ => (x, y),
    };
    (x.rem_euclid(width) as u32, y as u32)
}
