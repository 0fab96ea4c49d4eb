//! Pages filled from a file, as the residency would.

use std::collections::HashMap;

use relief_formats::file::Relief;
use relief_formats::tile::TileKey;
use relief_formats::tiles::Tiles;
use relief_shaders::pages::{USABLE, key};

use super::page_set::PageSet;
use super::planet::TestPlanet;

/// Pages of a file's tiles, as its reader gives them.
pub fn of_file(planet: &TestPlanet, relief: &Relief) -> PageSet {
    let (tiles, grid, root) = (Tiles::new(relief, 0), relief.grid(), relief.grid().root_level());
    let mut set = PageSet::empty(planet);
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
            let codes = tiles.deviations(tile).unwrap().unwrap();
            set.push_codes(codes.into_iter().map(u32::from));
            set.insert(key(level, x, y), USABLE | slot);
            bounds.insert(tile, extremes);
        }
    }
    set
}
