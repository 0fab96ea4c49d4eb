//! Which tiles are never dropped.

use relief_formats::tile::TileKey;

use super::closure;
use crate::planet::Planet;

/// Tiles of the coarsest levels that are never dropped: at most this share of the slots.
const PINNED_SHARE: u32 = 4;
/// Levels below the root that are never dropped.
const PINNED_LEVELS: u32 = 2;

/// The tiles that a file has of its coarsest levels, as long as they are a small part of the slots.
pub(super) fn tiles(planet: &Planet, slots: u32) -> Vec<TileKey> {
    let (grid, relief) = (planet.grid(), planet.relief());
    let (root, mut keys) = (grid.root_level(), Vec::new());
    for level in (root.saturating_sub(PINNED_LEVELS)..=root).rev() {
        // What cannot be read is an error when it is asked for.
        let find = |key| relief.check_whole().and_then(|()| relief.find(key));
        let stored: Vec<TileKey> =
            closure::level(grid, level).filter(|&key| matches!(find(key), Ok(Some(_)))).collect();
        if level < root && (keys.len() + stored.len()) * PINNED_SHARE as usize > slots as usize {
            break;
        }
        keys.extend(stored);
    }
    keys
}
