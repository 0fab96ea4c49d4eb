//! What a file's step costs: its level-0 nodes against the heights they were rounded from.

use rayon::prelude::*;
use relief_formats::file::{Entry, FormatError, Relief};
use relief_formats::tile::{TILE_CELLS, TILE_NODES};
use relief_formats::tiles::Tiles;

use super::error::Errors;
use crate::bake::Plan;
use crate::source::{DATA, NodeWindow, SourceSet, VOID};
use relief_front::error::ToolError;

/// Compares every measured level-0 node with its unrounded height. `sources` use the kernel that
/// the file was baked with.
///
/// # Errors
/// A tile or an input that cannot be decoded.
pub fn errors(
    tiles: &Tiles<'_>,
    sources: &SourceSet,
    plan: &Plan,
    of_file: impl Fn(FormatError) -> ToolError + Sync,
) -> Result<Errors, ToolError> {
    let relief = tiles.relief();
    let found: Vec<Errors> = finest(relief)
        .map_err(&of_file)?
        .par_iter()
        .map(|entry| {
            let nodes = tiles.nodes(entry.key).map_err(&of_file)?;
            let window = NodeWindow {
                level: 0,
                x0: i64::from(entry.key.x * TILE_CELLS),
                y0: i64::from(entry.key.y * TILE_CELLS),
                nx: TILE_CELLS as usize,
                ny: TILE_CELLS as usize,
            };
            let exact = exact(sources, plan, &window)?;
            let mut errors = Errors::default();
            for (at, height_m) in exact.iter().enumerate() {
                if let Some(height_m) = height_m {
                    let (column, row) = (at % window.nx, at / window.nx);
                    errors.add(f64::from(nodes[row * TILE_NODES + column]) * relief.step_m() - f64::from(*height_m));
                }
            }
            Ok(errors)
        })
        .collect::<Result<_, ToolError>>()?;
    Ok(found.into_iter().fold(Errors::default(), Errors::and))
}

/// Index entries of level 0, in file order.
///
/// # Errors
/// A damaged index.
pub fn finest(relief: &Relief) -> Result<Vec<Entry>, FormatError> {
    relief.entries().filter(|entry| entry.as_ref().map_or(true, |entry| entry.key.level == 0)).collect()
}

/// Heights that the last source with data gives at a window's nodes, metres; none where there is
/// no such source, or where it is too coarse for level 0.
fn exact(sources: &SourceSet, plan: &Plan, window: &NodeWindow) -> Result<Vec<Option<f32>>, ToolError> {
    let count = window.nx * window.ny;
    let (mut settled, mut exact) = (vec![false; count], vec![None; count]);
    for source in (0..sources.len()).rev().filter(|&source| sources.covers(source, &plan.grid, window)) {
        let block = sources.sample(source, &plan.grid, window)?;
        for at in (0..count).filter(|&at| block.state[at] != VOID) {
            if !settled[at] && block.state[at] == DATA && plan.finest[source] == 0 {
                exact[at] = Some(block.height_m[at]);
            }
            settled[at] = true;
        }
        if settled.iter().all(|&settled| settled) {
            break;
        }
    }
    Ok(exact)
}
