//! A file whose levels are absent here and there, with the nodes that its readers interpolate.

use std::sync::{Arc, OnceLock};

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;

use crate::planet::Planet;
use relief_tests::sample_file::Sample;

const GRID: Grid = Grid::new(11, false);

/// Level 0 is there in 45 x 45 degrees, level 1 in three times that, level 2 but for a quarter.
pub fn absent(key: TileKey) -> bool {
    match key.level {
        0 => !((4..=5).contains(&key.x) && (3..=4).contains(&key.y)),
        1 => !((1..=3).contains(&key.x) && (1..=2).contains(&key.y)),
        2 => key.x == 3,
        _ => false,
    }
}

/// The planet of [`nodes`], without the tiles that `absent` tells.
pub fn planet(absent: fn(TileKey) -> bool) -> Arc<Planet> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.relief");
    Sample { absent, q: |_, i, j| node(i, j), ..Sample::new(Body::earth(), GRID.m) }.write(&path);
    Planet::open(&path).unwrap()
}

/// Height of a node of level 0, steps.
pub fn node(i: u32, j: u32) -> i32 {
    static NODES: OnceLock<Vec<i32>> = OnceLock::new();
    let width = GRID.width(0);
    NODES.get_or_init(nodes)[(j * width + i % width) as usize]
}

/// All of them: rough where tiles are present, on their borders and beyond between those of the
/// next coarser level, as the format has it.
fn nodes() -> Vec<i32> {
    let (width, height) = (GRID.width(0), GRID.height(0));
    let mut nodes = vec![0; (width * (height + 1)) as usize];
    let at = |i: u32, j: u32| (j * width + i % width) as usize;
    for level in (0..=GRID.root_level()).rev() {
        let step = 1 << level;
        for (i, j) in (0..=height).step_by(step).flat_map(|j| (0..width).step_by(step).map(move |i| (i, j))) {
            let (x, y, step) = (i >> level, j >> level, step as u32);
            let new = level == GRID.root_level() || (x | y) & 1 == 1;
            if new && (level == GRID.root_level() || inside(level, x, y)) {
                nodes[at(i, j)] = rough(i, j);
            } else if new {
                let (dx, dy) = (step * (x & 1), step * (y & 1));
                let ends = [(i + width - dx, j - dy), (i + dx, j - dy), (i + width - dx, j + dy), (i + dx, j + dy)];
                let sum: i32 = ends.iter().map(|&(i, j)| nodes[at(i, j)]).sum();
                // Of a side's two ends each counts twice: halves are rounded up either way.
                nodes[at(i, j)] = (sum + 2) >> 2;
            }
        }
    }
    nodes
}

/// True when all tiles of a level that have a node are present.
fn inside(level: u32, x: u32, y: u32) -> bool {
    let (columns, rows) = (GRID.tiles_x(level), GRID.tiles_y(level));
    let tiles_x = [x / 256 % columns, (x + GRID.width(level) - 1) % GRID.width(level) / 256];
    let tiles_y = [(y / 256).min(rows - 1), y.saturating_sub(1) / 256];
    tiles_y.into_iter().all(|y| tiles_x.into_iter().all(|x| !absent(TileKey::new(level, x, y))))
}

fn rough(i: u32, j: u32) -> i32 {
    match j {
        0 => 1600,
        j if j == GRID.height(0) => -2400,
        _ => {
            // Calm in places, so that small codes occur.
            let amplitude = 1 + (60_000 >> (2 * ((i / 90 + j / 70) % 5)));
            let noise = (i.wrapping_mul(0x9e37_79b1) ^ j.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
            (noise >> 8) as i32 % amplitude + (i as i32 % 3000 - 1500).abs() * 8
        }
    }
}
