//! The root pages' codes, with those of the levels above at their even nodes.

use std::sync::OnceLock;

use relief_formats::derive::crown::{ROWS, columns, crown};
use relief_formats::file::FormatError;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

use crate::planet::Planet;

/// Worked out once, from the nodes and codes of the whole root level.
#[derive(Default)]
pub(super) struct Crown {
    codes: OnceLock<Vec<u8>>,
}

impl Crown {
    /// The codes of a tile of the root level, 257 x 257.
    pub fn tile(&self, planet: &Planet, key: TileKey) -> Result<Vec<u8>, FormatError> {
        let columns = columns(planet.grid());
        let codes = match self.codes.get() {
            Some(codes) => codes,
            None => {
                let made = whole(planet)?;
                self.codes.get_or_init(|| made)
            }
        };
        let west = (key.x * TILE_CELLS) as usize;
        let node = |k: usize| codes[k / TILE_NODES * columns + (west + k % TILE_NODES) % columns];
        Ok((0..TILE_NODES * TILE_NODES).map(node).collect())
    }
}

fn whole(planet: &Planet) -> Result<Vec<u8>, FormatError> {
    let (grid, tiles) = (planet.grid(), planet.tiles());
    let columns = columns(grid);
    let (mut nodes, mut codes) = (vec![0; ROWS * columns], vec![0; ROWS * columns]);
    let root = grid.root_level();
    for x in 0..grid.tiles_x(root) {
        let key = TileKey::new(root, x, 0);
        let tile_nodes = tiles.nodes(key)?;
        let tile_codes = tiles.deviations(key)?.unwrap_or_default();
        for (k, (&node, &code)) in tile_nodes.iter().zip(&tile_codes).enumerate() {
            let at = k / TILE_NODES * columns + (x as usize * TILE_CELLS as usize + k % TILE_NODES) % columns;
            (nodes[at], codes[at]) = (node, code);
        }
    }
    crown(grid, &nodes, &mut codes);
    Ok(codes)
}
