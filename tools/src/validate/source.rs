//! A file against the rasters it was baked from, resampled once more.
//!
//! At each node the last input with data counts, as in a bake; where that input is coarser than
//! the level, nodes lie between those of the level above and there is nothing to compare. Nodes
//! are compared at the coarsest level that has them, each once.

use rayon::prelude::*;
use relief_formats::file::{Entry, Relief};
use relief_formats::tile::TILE_NODES;

use super::check::Check;
use super::finding::{Findings, Place};
use super::inputs::{Against, Input, record_of, records};
use super::map::Map;
use super::report::SourceDifference;
use crate::source::{DATA, FILLED, NodeWindow, VOID};
use relief_front::error::ToolError;

/// Half a step is exact, but the sources' heights pass through f32 on their way.
const ALLOWANCE_M: f64 = 1e-3;

/// Compares all nodes; `step` is called once for each tile.
///
/// # Errors
/// An input that cannot be opened or decoded.
pub(super) fn source(
    map: &Map<'_>,
    against: &Against,
    memory_bytes: u64,
    findings: &Findings,
    step: impl Fn() + Sync,
) -> Result<SourceDifference, ToolError> {
    let relief = map.relief;
    let records = records(relief.metadata());
    if records.len() != against.inputs.len() {
        let what = format!("{} inputs to compare with, the file has {}", against.inputs.len(), records.len());
        findings.add(Check::SourceRecord, Place::default(), what);
    }
    let share = memory_bytes / 2 / against.inputs.len().max(1) as u64;
    let inputs = against
        .inputs
        .iter()
        .enumerate()
        .map(|(n, path)| Input::open(relief, against, path, record_of(&records, n, path), share, findings))
        .collect::<Result<Vec<_>, _>>()?;
    let compare = Compare { map, inputs: &inputs, findings, bound_m: relief.step_m() / 2.0 };
    let count = relief.tile_count();
    let mut total = Sum::default();
    // In chunks and in order, so that the sum is the same whatever the threads do.
    for first in (0..count).step_by(4096) {
        let tiles = (first..count.min(first + 4096)).into_par_iter().map(|n| {
            let entry = relief.entry(n).map_err(|error| damaged(relief, error))?;
            let sum = compare.tile(&entry)?;
            step();
            Ok(sum)
        });
        for sum in tiles.collect::<Result<Vec<_>, ToolError>>()? {
            total.add(sum);
        }
    }
    Ok(SourceDifference {
        max_m: total.max_m,
        place: total.place,
        rms_m: if total.nodes == 0 { 0.0 } else { (total.squares / total.nodes as f64).sqrt() },
        nodes: total.nodes,
        bound_m: compare.bound_m,
    })
}

/// The file decoded before; this is for an error that then cannot be.
fn damaged(relief: &Relief, error: relief_formats::file::FormatError) -> ToolError {
    ToolError::of_file(std::path::Path::new(&format!("m = {} file", relief.header().m)))(error)
}

/// Differences summed over a tile or a file.
#[derive(Default)]
struct Sum {
    nodes: u64,
    squares: f64,
    max_m: f64,
    place: Option<Place>,
}

impl Sum {
    fn add(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.squares += other.squares;
        if other.max_m > self.max_m || self.place.is_none() {
            (self.max_m, self.place) = (other.max_m, other.place);
        }
    }
}

struct Compare<'a> {
    map: &'a Map<'a>,
    inputs: &'a [Input],
    findings: &'a Findings,
    bound_m: f64,
}

impl Compare<'_> {
    fn tile(&self, entry: &Entry) -> Result<Sum, ToolError> {
        let (map, key) = (self.map, entry.key);
        let (grid, body) = (map.grid, map.relief.body());
        let window = NodeWindow::of_tile(key);
        let (expected, state) = self.expected(&window)?;
        let root = key.level == grid.root_level();
        let new = |at: usize| root || ((at / TILE_NODES) | (at % TILE_NODES)) % 2 == 1;
        let nodes = map.tiles.nodes(key).map_err(|error| damaged(map.relief, error))?;
        let filled = map.tiles.filled(key).map_err(|error| damaged(map.relief, error))?;
        let step_m = map.relief.step_m();
        let place = |at: usize| Place::node(body, &grid, key, (at % TILE_NODES, at / TILE_NODES));
        let mut sum = Sum::default();
        let (mut worst, mut beyond, mut marks) = (0, 0, Vec::new());
        for at in (0..nodes.len()).filter(|&at| new(at)) {
            match state[at] {
                Origin::Height(source_state) => {
                    let off_m = (f64::from(nodes[at]) * step_m - f64::from(expected[at])).abs();
                    sum.nodes += 1;
                    sum.squares += off_m * off_m;
                    if off_m > sum.max_m || sum.nodes == 1 {
                        (sum.max_m, worst) = (off_m, at);
                    }
                    beyond += u64::from(off_m > self.bound_m + ALLOWANCE_M);
                    if filled[at] != (source_state == FILLED) {
                        marks.push(at);
                    }
                }
                Origin::Void if (map.is_dense() || root) && !filled[at] => marks.push(at),
                Origin::Void | Origin::Coarser => {}
            }
        }
        if sum.nodes > 0 {
            sum.place = Some(place(worst));
        }
        if beyond > 0 {
            let (height_m, source_m) = (f64::from(nodes[worst]) * step_m, expected[worst]);
            let what = format!(
                "{height_m} m, the source has {source_m} m ({beyond} nodes beyond {} m)",
                self.bound_m + ALLOWANCE_M
            );
            self.findings.add(Check::SourceHeight, place(worst), what);
        }
        if let Some(&first) = marks.first() {
            let what = format!(
                "marked as filled: {}, the source says {} ({} nodes)",
                filled[first],
                !filled[first],
                marks.len()
            );
            self.findings.add(Check::SourceFilled, place(first), what);
        }
        Ok(sum)
    }

    /// Heights of the inputs at a window's nodes, metres, and where they come from.
    fn expected(&self, window: &NodeWindow) -> Result<(Vec<f32>, Vec<Origin>), ToolError> {
        let mut height_m = vec![0.0; window.nx * window.ny];
        let mut origin = vec![Origin::Void; window.nx * window.ny];
        for input in self.inputs.iter().rev().filter(|input| input.set.covers(0, &self.map.grid, window)) {
            let block = input.set.sample(0, &self.map.grid, window)?;
            for (at, (&h, &state)) in block.height_m.iter().zip(&block.state).enumerate() {
                if origin[at] == Origin::Void && state != VOID {
                    debug_assert!(state == DATA || state == FILLED);
                    height_m[at] = h;
                    origin[at] = if input.finest <= window.level { Origin::Height(state) } else { Origin::Coarser };
                }
            }
            if !origin.contains(&Origin::Void) {
                break;
            }
        }
        Ok((height_m, origin))
    }
}

/// Where a node's height comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// No input has data there.
    Void,
    /// An input that is as fine as the level, with this state.
    Height(u8),
    /// An input that is coarser than the level.
    Coarser,
}
