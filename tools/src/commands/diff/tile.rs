//! The heights of one tile in both files.

use std::sync::{Mutex, PoisonError};

use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

use super::compare::{Largest, Side};
use super::map::Map;
use relief_front::error::ToolError;

/// What differs in a tile.
pub struct TileDiff {
    pub level: u32,
    /// Nodes that differ, of those that no tile east or north of it shares.
    pub nodes: u64,
    pub largest: Option<Largest>,
    /// Squares of the differences in metres, each as often as it stands for nodes of level 0.
    pub weighted_square_sum: f64,
}

/// Compares the heights of a tile that either file has; the other's are interpolated.
pub fn compare_tile(sides: &[Side<'_>; 2], key: TileKey, map: Option<&Mutex<&mut Map>>) -> Result<TileDiff, ToolError> {
    let a = sides[0].tiles.nodes(key).map_err(sides[0].failed())?;
    let b = sides[1].tiles.nodes(key).map_err(sides[1].failed())?;
    let steps_m = [sides[0].relief().step_m(), sides[1].relief().step_m()];
    let leaf = leaf_quadrants(sides, key)?;
    let weight = f64::from(key.level).exp2().powi(2);
    let mut diff = TileDiff { level: key.level, nodes: 0, largest: None, weighted_square_sum: 0.0 };
    let mut spots = Vec::new();
    let mut most_m = 0.0;
    for (at, (&qa, &qb)) in a.iter().zip(b.iter()).enumerate() {
        let (a_m, b_m) = (f64::from(qa) * steps_m[0], f64::from(qb) * steps_m[1]);
        let difference_m = b_m - a_m;
        if difference_m == 0.0 {
            continue;
        }
        let (x, y) = (at % TILE_NODES, at / TILE_NODES);
        if difference_m.abs() > most_m {
            most_m = difference_m.abs();
            let node = [key.x * TILE_CELLS + x as u32, key.y * TILE_CELLS + y as u32];
            diff.largest = Some(Largest { difference_m, a_m, b_m, tile: key, node });
        }
        let side = TILE_CELLS as usize;
        if x == side || y == side {
            continue;
        }
        diff.nodes += 1;
        if leaf[usize::from(x >= side / 2) + 2 * usize::from(y >= side / 2)] {
            diff.weighted_square_sum += weight * difference_m * difference_m;
            if map.is_some() {
                spots.push((key.x * TILE_CELLS + x as u32, key.y * TILE_CELLS + y as u32, difference_m as f32));
            }
        }
    }
    if let Some(map) = map {
        map.lock().unwrap_or_else(PoisonError::into_inner).deposit(key.level, &spots);
    }
    Ok(diff)
}

/// Which quarters of a tile no finer tile of either file covers.
fn leaf_quadrants(sides: &[Side<'_>; 2], key: TileKey) -> Result<[bool; 4], ToolError> {
    let mut leaf = [true; 4];
    if key.level == 0 {
        return Ok(leaf);
    }
    for (quadrant, leaf) in (0u32..).zip(&mut leaf) {
        let child = TileKey::new(key.level - 1, 2 * key.x + quadrant % 2, 2 * key.y + quadrant / 2);
        for side in sides {
            *leaf &= side.relief().find(child).map_err(side.failed())?.is_none();
        }
    }
    Ok(leaf)
}
