//! Pages filled from a file, as the residency would.

use std::collections::HashMap;

use relief_formats::derive::crown;
use relief_formats::file::Relief;
use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;
use relief_formats::tiles::Tiles;
use relief_shaders::pages::{NODES, USABLE, key};

use super::planet::TestPlanet;
use crate::page_set::PageSet;

/// Pages of a file's tiles, as its reader gives them.
pub fn of_file(planet: &TestPlanet, relief: &Relief) -> PageSet {
    let (tiles, grid, root) = (Tiles::new(relief, 0), relief.grid(), relief.grid().root_level());
    let mut set = PageSet::empty(planet.planet());
    let crown = crown_codes(&tiles);
    let mut bounds: HashMap<TileKey, Vec<[f32; 2]>> = HashMap::new();
    let metres = |q: i32| (f64::from(q) * relief.step_m()) as f32;
    for level in (0..=root).rev() {
        for (x, y) in (0..grid.tiles_y(level)).flat_map(|y| (0..grid.tiles_x(level)).map(move |x| (x, y))) {
            let tile = TileKey::new(level, x, y);
            let slot = set.slots();
            set.heights.extend(tiles.nodes(tile).unwrap().iter().map(|&q| metres(q)));
            let mut extremes: Vec<[f32; 2]> =
                tiles.extremes(tile).unwrap().iter().map(|e| [metres(e.min), metres(e.max)]).collect();
            if level < root {
                // A file rounds each level outwards by itself; intervals must nest.
                let (parent, (east, north)) = (&bounds[&tile.parent()], tile.quadrant());
                for (k, own) in extremes.iter_mut().enumerate() {
                    let around = parent[(k / 256 + 64 * north) * 128 + k % 128 / 2 + 64 * east];
                    *own = [own[0].max(around[0]), own[1].min(around[1])];
                }
            }
            set.bounds.extend(extremes.iter().flatten().map(|v| v.to_bits()));
            let codes = match level == root {
                true => (0..NODES * NODES)
                    .map(|k| {
                        crown[(k / NODES * crown_columns(grid) + (256 * x + k % NODES) % crown_columns(grid)) as usize]
                    })
                    .collect(),
                false => tiles.deviations(tile).unwrap().unwrap(),
            };
            set.push_codes(codes.into_iter().map(u32::from));
            set.insert(key(level, x, y), USABLE | slot);
            bounds.insert(tile, extremes);
        }
    }
    set
}

/// Columns of nodes of the coarsest level.
fn crown_columns(grid: Grid) -> u32 {
    crown::columns(grid) as u32
}

/// Codes of the coarsest level's nodes with those of the levels above, row by row.
fn crown_codes(tiles: &Tiles<'_>) -> Vec<u8> {
    let grid = tiles.relief().grid();
    let columns = crown_columns(grid) as usize;
    let (mut nodes, mut codes) = (vec![0; crown::ROWS * columns], vec![0; crown::ROWS * columns]);
    for x in 0..grid.tiles_x(grid.root_level()) {
        let tile = TileKey::new(grid.root_level(), x, 0);
        let (tile_nodes, tile_codes) = (tiles.nodes(tile).unwrap(), tiles.deviations(tile).unwrap().unwrap());
        for k in 0..(NODES * NODES) as usize {
            let at = k / 257 * columns + (x as usize * 256 + k % 257) % columns;
            (nodes[at], codes[at]) = (tile_nodes[k], tile_codes[k]);
        }
    }
    crown::crown(grid, &nodes, &mut codes);
    codes
}
