//! Codes of deviations in a sparse file of several stages: a node is active wherever a node below
//! it is, across tiles, levels, stages, and the seam, so that a mesh of longest-edge bisection closes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::common::Folder;
use crate::common::rasters::Raster;
use relief_formats::file::Relief;
use relief_formats::grid::Grid;
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

const LAST: usize = TILE_NODES - 1;

/// A smooth globe with a fine, rough region across the antimeridian: 13 levels of rows, so that
/// level 4 on is worked out from summaries, and most tiles are absent.
fn bake(folder: &Folder) -> PathBuf {
    let (globe, region, file) = (folder.path("globe.tif"), folder.path("region.tif"), folder.path("out.relief"));
    let grain = |x: usize, y: usize| (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) >> 7;
    Raster::world(720).write(&globe, |x, y| ((x as f32 * 0.05).sin() * (y as f32 * 0.03).cos() * 4000.0).round());
    let transform = Some([172.0, 0.021, 0.0, 40.0, 0.0, -0.021]);
    Raster { size: (700, 600), transform, ..Raster::world(700) }.write(&region, |x, y| (grain(x, y) % 900) as f32);
    let run = relief_bake!("bake", "--quiet", "--vertical=ellipsoid", "-o", file, globe, region);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let found = relief_bake!("validate", file, "--quiet");
    assert_eq!(found.code, 0, "{}{}", found.stdout, found.stderr);
    file
}

/// Codes of the present tiles.
type Codes = HashMap<TileKey, Vec<u8>>;

fn read(file: &Path) -> (Grid, Codes) {
    let relief = Relief::open(file).unwrap();
    let tiles = Tiles::new(&relief, 64 << 20);
    let keys = relief.entries().map(|entry| entry.unwrap().key);
    (relief.grid(), keys.map(|key| (key, tiles.deviations(key).unwrap().unwrap())).collect())
}

static BAKED: LazyLock<(Grid, Codes)> = LazyLock::new(|| {
    let folder = Folder::new();
    read(&bake(&folder))
});

/// A node whose code is below one of its children's, or that has two codes.
fn fault(grid: &Grid, codes: &Codes) -> Option<String> {
    let at = |codes: &[u8], i: usize, j: usize| codes[j * TILE_NODES + i];
    for (&key, own) in codes {
        for (i, j) in (1..LAST).step_by(2).flat_map(|j| (1..LAST).step_by(2).map(move |i| (i, j))) {
            let centre = at(own, i, j);
            let sides = [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)];
            if sides.iter().any(|&(i, j)| at(own, i, j) > centre) {
                return Some(format!("{key:?}: centre ({i}, {j}) is below its sides"));
            }
            let Some(parent) = codes.get(&key.parent()).filter(|_| key.level < grid.root_level()) else { continue };
            let (x, y) = (key.quadrant().0 * LAST / 2 + i / 2, key.quadrant().1 * LAST / 2 + j / 2);
            let mut corners = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)].into_iter();
            if corners.any(|(x, y)| (x + y) % 2 == 1 && at(parent, x, y) < centre) {
                return Some(format!("{key:?}: centre ({i}, {j}) is above a side of its parent"));
            }
        }
        let east = codes.get(&TileKey::new(key.level, (key.x + 1) % grid.tiles_x(key.level), key.y));
        let north = codes.get(&TileKey::new(key.level, key.x, key.y + 1));
        for k in 0..TILE_NODES {
            let torn = |other: &Vec<u8>, ours: (usize, usize), theirs: (usize, usize)| {
                at(own, ours.0, ours.1) != at(other, theirs.0, theirs.1)
            };
            if east.is_some_and(|o| torn(o, (LAST, k), (0, k))) || north.is_some_and(|o| torn(o, (k, LAST), (k, 0))) {
                return Some(format!("{key:?}: two codes on an edge, at {k}"));
            }
        }
    }
    None
}

#[test]
fn every_node_is_at_least_its_children() {
    let (grid, mut codes) = BAKED.clone();
    assert!(grid.root_level() > 4, "more than one stage");
    let fine: Vec<TileKey> = codes.keys().filter(|key| key.level == 0).copied().collect();
    let columns = grid.tiles_x(0);
    assert!(fine.iter().any(|key| key.x == 0) && fine.iter().any(|key| key.x == columns - 1), "{fine:?}");
    assert_eq!(fault(&grid, &codes), None);

    // A code that is too low, or one of an edge's two, is seen.
    let inner = TILE_NODES * 101 + 102;
    for at in [inner, TILE_NODES * 101 + LAST] {
        let key = *fine.iter().find(|key| key.x == columns - 1).unwrap();
        let right = codes[&key][at];
        codes.get_mut(&key).unwrap()[at] = right + 90;
        assert!(fault(&grid, &codes).is_some(), "node {at}");
        codes.get_mut(&key).unwrap()[at] = right;
    }
}

/// Whatever a tile's area touches one level up is there.
#[test]
fn levels_differ_by_one_at_most() {
    let (grid, codes) = &*BAKED;
    let mut added = 0;
    for key in codes.keys().filter(|key| key.level < grid.root_level()) {
        let (columns, rows) = (grid.tiles_x(key.level) as i32, grid.tiles_y(key.level) as i32);
        for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
            let (x, y) = ((key.x as i32 + dx).rem_euclid(columns) as u32, key.y as i32 + dy);
            if (0..rows).contains(&y) {
                let above = TileKey::new(key.level + 1, x / 2, y as u32 / 2);
                assert!(codes.contains_key(&above), "{key:?} touches {above:?}");
                added += u32::from(!codes.contains_key(&TileKey::new(key.level, x, y as u32)));
            }
        }
    }
    assert!(added > 0, "some tile has an absent neighbour");
}
