//! Small files made here, whole, with planes that are right or wrong on purpose.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use relief_formats::body::Body;
use relief_formats::codec::nodes::{HALF, quarter};
use relief_formats::derive::crown::{crown, lay};
use relief_formats::derive::extremes::Extremes;
use relief_formats::derive::{Base, Field, Window, derive_block, padding};
use relief_formats::file::writer::{FileSpec, write};
use relief_formats::file::{Entry, Header, Metadata};
use relief_formats::grid::Grid;
use relief_formats::mesh::{self, MeshLayout, PatchMesh, patch_mesh};
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_formats::tile_planes::{TileSamples, encode};

use crate::common::Folder;

/// A file in the making: a whole planet of the given m, in steps of 1/4 m.
pub struct World {
    pub body: Body,
    pub m: u32,
    /// The tiles there are, but for the root level's, which are always there; `None`: all.
    pub present: Option<BTreeSet<TileKey>>,
    /// Height of level-0 node (x, y) of a map of h rows, in steps; the poles' rows must be constant.
    pub height: fn(u32, u32, u32) -> i32,
    pub filled: fn(u32, u32) -> bool,
    pub mesh: PatchMesh,
}

/// The decoded planes of a tile.
pub struct Planes {
    pub nodes: Vec<i32>,
    pub mip: Vec<i32>,
    pub extremes: Vec<Extremes>,
    pub deviations: Vec<u8>,
    pub filled: Vec<bool>,
}

pub type Tiles = BTreeMap<TileKey, Planes>;

/// Hills that close at the seam and at the poles of a map of h rows.
pub fn hills(x: u32, y: u32, h: u32) -> i32 {
    let (u, v) =
        (f64::from(x) * std::f64::consts::PI / f64::from(h), f64::from(y) * std::f64::consts::PI / f64::from(h));
    let pole = v.sin().abs();
    let bumps = (16.0 * u).sin() * (9.0 * v).cos() * 900.0 + (64.0 * u + 3.0 * v).cos() * 150.0;
    let grain = ((x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) >> 13) % 23;
    if y.is_multiple_of(h) { -40 } else { (pole * (bumps + f64::from(grain))) as i32 - 40 }
}

impl World {
    pub fn new(m: u32) -> Self {
        Self::on(Body::earth(), m)
    }

    pub fn on(body: Body, m: u32) -> Self {
        let mesh = patch_mesh(&body, &Grid::new(m, body.is_plane()), MeshLayout::Aligned);
        Self { body, m, present: None, height: hills, filled: |_, _| false, mesh }
    }

    pub fn plane(m: u32) -> Self {
        let body = Body::Plane { crs_wkt: "LOCAL".into(), x0: 1000.0, y0: -500.0, dx: 30.0, dy: 30.0 };
        Self { height: |x, y, h| hills(x, y + 100, 2 * h), ..Self::on(body, m) }
    }

    pub fn sparse(m: u32, finest: &[(u32, u32)]) -> Self {
        let mut here: BTreeSet<TileKey> = finest.iter().map(|&(x, y)| TileKey::new(0, x, y)).collect();
        let mut present = here.clone();
        let grid = Grid::new(m, false);
        for level in 0..grid.root_level() {
            let beside = |key: TileKey| {
                (-1..=1).flat_map(move |dy| {
                    (-1..=1).map(move |dx| (key.x.wrapping_add_signed(dx), key.y.wrapping_add_signed(dy)))
                })
            };
            let near = here.iter().copied().flat_map(beside).map(|(x, y)| (x & (grid.tiles_x(level) - 1), y));
            let on_map = near.filter(|&(_, y)| y < grid.tiles_y(level));
            here = on_map.map(|(x, y)| TileKey::new(level, x, y).parent()).collect();
            present.extend(&here);
        }
        Self { present: Some(present), ..Self::new(m) }
    }

    pub fn grid(&self) -> Grid {
        Grid::new(self.m, self.body.is_plane())
    }

    fn has(&self, key: TileKey) -> bool {
        self.present.as_ref().is_none_or(|present| key.level == self.grid().root_level() || present.contains(&key))
    }

    fn keys(&self) -> Vec<TileKey> {
        let grid = self.grid();
        let all = (0..=grid.root_level()).flat_map(|level| {
            (0..grid.tiles_y(level)).flat_map(move |y| (0..grid.tiles_x(level)).map(move |x| TileKey::new(level, x, y)))
        });
        all.filter(|&key| self.has(key)).collect()
    }

    /// Wrapped, carried over the poles, or mirrored at the edge.
    fn home(&self, level: u32, x: i32, y: i32) -> (i32, i32) {
        let grid = self.grid();
        let (w, h) = (grid.width(level) as i32, grid.height(level) as i32);
        if grid.plane {
            return (w - (w - x.abs()).abs(), h - (h - y.abs()).abs());
        }
        match y {
            y if y < 0 => ((x + w / 2).rem_euclid(w), -y),
            y if y > h => ((x + w / 2).rem_euclid(w), 2 * h - y),
            y => (x.rem_euclid(w), y),
        }
    }

    fn owner(&self, level: u32, x: i32, y: i32) -> TileKey {
        let grid = self.grid();
        let (x, y) = self.home(level, x, y);
        let (tx, ty) = (x as u32 / 256, y as u32 / 256);
        TileKey::new(level, tx.min(grid.tiles_x(level) - 1), ty.min(grid.tiles_y(level) - 1))
    }

    /// S_0 over the whole map: heights where a level-0 tile is, interpolated from above elsewhere.
    fn surface(&self) -> Field<i32> {
        let grid = self.grid();
        let whole = |level: u32| Window::new(0, 0, grid.width(level) as usize + 1, grid.height(level) as usize + 1);
        let mut above: Option<Field<i32>> = None;
        for level in (0..=grid.root_level()).rev() {
            let field = Field::from_fn(whole(level), |x, y| {
                let sharers = [(0, 0), (-1, 0), (0, -1), (-1, -1)].map(|(dx, dy)| self.owner(level, x + dx, y + dy));
                match &above {
                    Some(above) if !sharers.iter().all(|&key| self.has(key)) => {
                        let (w, s) = (x >> 1, y >> 1);
                        let (e, n) = (w + (x & 1), s + (y & 1));
                        (above.at(w, s) + above.at(e, s) + above.at(w, n) + above.at(e, n) + 2) >> 2
                    }
                    _ => {
                        let (w, h) = (grid.width(0) as i32, grid.height(0) as i32);
                        let (x, y) = (x << level, y << level);
                        if grid.plane {
                            (self.height)(x.min(w - 1) as u32, y.min(h - 1) as u32, h as u32)
                        } else {
                            (self.height)((x % w) as u32, y as u32, h as u32)
                        }
                    }
                }
            });
            above = Some(field);
        }
        above.unwrap()
    }

    /// The right planes of all tiles.
    pub fn tiles(&self) -> Tiles {
        let grid = self.grid();
        let levels = grid.root_level() + 1;
        let core = Window::new(0, 0, grid.width(0) as usize, grid.height(0) as usize);
        let surface = self.surface();
        let nodes = Field::from_fn(core.expand(padding(levels)).nodes(), |x, y| {
            let (x, y) = self.home(0, x, y);
            surface.at(x, y)
        });
        let absent = |level: u32, x: i32, y: i32| !self.has(self.owner(level, x, y));
        let base = Base { level: 0, nodes, mip: None, below: None };
        let mut block = derive_block(base, core, levels, self.present.is_some().then_some(&absent));
        let codes = crown(grid, &[&block.next]);
        if let Some(root) = block.levels.last_mut() {
            lay(&codes, &mut root.deviations);
        }
        let tile = |key: TileKey| {
            let planes = &block.levels[key.level as usize];
            let (x0, y0) = (key.x as i32 * 256, key.y as i32 * 256);
            let window = Window::new(x0, y0, TILE_NODES, TILE_NODES);
            let nodes = planes.nodes.crop(window).into_data();
            Planes {
                mip: planes.mip.as_ref().map_or_else(|| nodes.clone(), |mip| mip.crop(window).into_data()),
                nodes,
                extremes: planes.extremes.crop(Window::new(x0 / 2, y0 / 2, HALF, HALF)).into_data(),
                deviations: planes.deviations.crop(window).into_data(),
                filled: Field::from_fn(window, |x, y| {
                    (self.filled)((x as u32) << key.level & (grid.width(0) - 1), (y as u32) << key.level)
                })
                .into_data(),
            }
        };
        self.keys().into_iter().map(|key| (key, tile(key))).collect()
    }

    /// Writes a file of these tiles.
    pub fn write(&self, path: &Path, tiles: &Tiles) -> Header {
        let grid = self.grid();
        let step_exponent = -2;
        let metadata = Metadata {
            body: self.body.clone(),
            vertical: "as given".into(),
            sources: Vec::new(),
            resampling: "auto".into(),
            fill: "none".into(),
            bound_m: 0.125,
            versions: BTreeMap::new(),
        };
        let encoded: Vec<_> = tiles
            .iter()
            .map(|(&key, planes)| {
                let root = key.level == grid.root_level();
                let mean = (!root).then(|| {
                    let parent = tiles.get(&key.parent()).map(|parent| quarter(&parent.mip, key.quadrant()));
                    parent.unwrap_or_else(|| vec![0; (HALF + 1) * (HALF + 1)])
                });
                encode(&TileSamples {
                    key,
                    root,
                    nodes: &planes.nodes,
                    mip: &planes.mip,
                    parent_mean: mean.as_deref(),
                    extremes: &planes.extremes,
                    deviations: &planes.deviations,
                    filled: &planes.filled,
                })
            })
            .collect();
        let entries: Vec<Entry> = encoded.iter().map(|tile| tile.entry(0)).collect();
        let (w, h) = (grid.width(0), grid.height(0));
        let corner = |x: u32, y: u32| (self.height)(x, y, h);
        let (south_pole_q, north_pole_q) = match grid.plane {
            true => (corner(0, 0), corner(w - 1, h - 1)),
            false => (corner(0, 0), corner(0, h)),
        };
        let mesh = mesh::encode_section(&self.mesh);
        let spec = FileSpec {
            body: &self.body,
            m: self.m,
            step_exponent,
            south_pole_q,
            north_pole_q,
            metadata: &metadata,
            mesh: &mesh,
        };
        write(path, &spec, &entries, |k, out| {
            encoded[k].planes.iter().for_each(|plane| out.extend_from_slice(plane));
            Ok(())
        })
        .unwrap()
    }

    /// A right file in a folder, and its bytes.
    pub fn good(&self, folder: &Folder) -> (PathBuf, Vec<u8>) {
        let path = folder.path("good.relief");
        self.write(&path, &self.tiles());
        let bytes = std::fs::read(&path).unwrap();
        (path, bytes)
    }
}
