//! The last step of a bake: the codes above the root level, which need the whole map.

use std::collections::BTreeMap;
use std::io;

use relief_formats::codec::{deviation, nodes};
use relief_formats::derive::crown::{crown, lay};
use relief_formats::derive::{Base, Field, Window};
use relief_formats::file::index::{Plane, digest};
use relief_formats::grid::Grid;
use relief_formats::tile::{TILE_CELLS, TILE_NODES};

use super::journal::{Journal, Placed};

/// The bytes of the root level's tiles with the crown's codes, by their number in `tiles`, whose
/// entries are put right. `parts` are what the last stage's blocks hand on.
///
/// # Errors
/// A work file that cannot be read.
pub fn crowned(
    grid: Grid,
    parts: &[&Base],
    tiles: &mut [Placed],
    journal: &Journal,
) -> io::Result<BTreeMap<usize, Vec<u8>>> {
    let crown = crown(grid, parts);
    let roots = tiles.iter_mut().enumerate().filter(|(_, tile)| tile.key.level == grid.root_level());
    roots
        .map(|(n, tile)| {
            let mut bytes = Vec::new();
            journal.read(tile, &mut bytes)?;
            Ok((n, with_crown(tile, &bytes, &crown)?))
        })
        .collect()
}

fn with_crown(tile: &mut Placed, bytes: &[u8], crown: &Field<u8>) -> io::Result<Vec<u8>> {
    let damaged = |error| io::Error::new(io::ErrorKind::InvalidData, error);
    let at = |plane: Plane| {
        let start: u32 = tile.lengths[..plane as usize].iter().sum();
        start as usize..(start + tile.lengths[plane as usize]) as usize
    };
    let (heights, deviations) = (at(Plane::Nodes), at(Plane::Deviation));
    let samples = nodes::decode_root(&bytes[heights]).map_err(damaged)?;
    let codes = deviation::decode(&bytes[deviations.clone()], &samples, true).map_err(damaged)?;
    let (x0, y0) = ((tile.key.x * TILE_CELLS) as i32, (tile.key.y * TILE_CELLS) as i32);
    let window = Window::new(x0, y0, TILE_NODES, TILE_NODES);
    let Some(mut codes) = Field::from_data(window, codes) else { return Ok(bytes.to_vec()) };
    lay(crown, &mut codes);
    let plane = deviation::encode(codes.data(), &samples, true);
    tile.lengths[Plane::Deviation as usize] = plane.len() as u32;
    tile.digests[Plane::Deviation as usize] = digest(codes.data());
    Ok([&bytes[..deviations.start], &plane, &bytes[deviations.end..]].concat())
}
