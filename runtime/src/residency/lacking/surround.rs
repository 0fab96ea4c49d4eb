//! A tile's nodes with those about it.

use relief_formats::derive::{Field, Window};
use relief_formats::file::FormatError;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

use crate::planet::Planet;

/// Nodes beyond each side.
pub(super) const BEYOND: usize = 2;
const SIDE: usize = TILE_NODES + 2 * BEYOND;

/// The nodes of a tile, (0, 0) its first, and of its surroundings; beyond the map's edge it goes on
/// as [`relief_formats::grid::Grid::home_node`] says.
pub(super) fn nodes(planet: &Planet, key: TileKey) -> Result<Field<i32>, FormatError> {
    let (grid, tiles) = (planet.grid(), planet.tiles());
    let cells = TILE_CELLS as i32;
    let window = Window::new(0, 0, TILE_NODES, TILE_NODES).expand(BEYOND as i32);
    let own = tiles.nodes(key)?;
    let mut field = Field::new(window);
    let mut other = (key, own.clone());
    for (k, out) in field.data_mut().iter_mut().enumerate() {
        let (x, y) = ((k % SIDE) as i32 - BEYOND as i32, (k / SIDE) as i32 - BEYOND as i32);
        if (0..=cells).contains(&x) && (0..=cells).contains(&y) {
            *out = own[y as usize * TILE_NODES + x as usize];
            continue;
        }
        let (x, y) = grid.home_node(key.level, key.x as i32 * cells + x, key.y as i32 * cells + y);
        let tile = |at: i32, count: u32| ((at / cells) as u32).min(count - 1);
        let at = TileKey::new(key.level, tile(x, grid.tiles_x(key.level)), tile(y, grid.tiles_y(key.level)));
        if other.0 != at {
            other = (at, tiles.nodes(at)?);
        }
        let (x, y) = (x - at.x as i32 * cells, y - at.y as i32 * cells);
        *out = other.1[y as usize * TILE_NODES + x as usize];
    }
    Ok(field)
}
