//! What a stage hands to the next: each block's summary, and the padded fields gathered from them.

use std::cell::Cell;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use relief_formats::derive::deviation::{CellDistances, Sources, cell_distances};
use relief_formats::derive::extremes::Extremes;
use relief_formats::derive::interval::Interval;
use relief_formats::derive::virtual_cells::raise_interpolated;
use relief_formats::derive::{Base, Below, Field, Window};

use super::compose::Composer;
use super::plan::{BLOCK_CELLS, BLOCK_LEVELS};
use relief_front::error::ToolError;

/// Cells along the side of a block's summary.
const SIDE: i32 = (BLOCK_CELLS >> BLOCK_LEVELS) as i32;
/// Levels for which distances are handed on.
const DISTANCE_LEVELS: usize = 3;

/// A block's summary at the level where the next stage starts.
#[derive(Clone, Debug)]
pub struct Handoff {
    /// Nodes, means, intervals, extremes, codes, distances.
    pub base: Base,
    /// Filled nodes.
    pub filled: Field<bool>,
}

/// Summaries of a level by block; blocks without any tile are made up when they are asked for.
pub struct Handoffs<'a> {
    composer: &'a Composer<'a>,
    level: u32,
    blocks: HashMap<(i32, i32), Arc<Handoff>>,
}

impl<'a> Handoffs<'a> {
    /// Summaries at `level`, none yet.
    pub fn new(composer: &'a Composer<'a>, level: u32) -> Self {
        Self { composer, level, blocks: HashMap::new() }
    }

    /// Adds the summary of block (x, y).
    pub fn insert(&mut self, x: i32, y: i32, handoff: Handoff) {
        self.blocks.insert((x, y), Arc::new(handoff));
    }

    /// The base of each block.
    pub fn bases(&self) -> impl Iterator<Item = &Base> {
        self.blocks.values().map(|handoff| &handoff.base)
    }

    /// The base of a stage over `core`, padded by `pad` cells, and its filled nodes.
    pub fn gather(&self, core: Window, pad: i32) -> Result<(Base, Field<bool>), ToolError> {
        let plan = self.composer.plan;
        let level = self.level;
        let (w, h) = (plan.grid.width(level) as i32, plan.grid.height(level) as i32);
        let padded = core.expand(pad);
        let blocks = self.around(padded)?;
        let near = Near { blocks: &blocks, last: Cell::new(None) };
        let (mut base_nodes, mut mip) = (Field::new(padded.nodes()), Field::new(padded.nodes()));
        let mut filled = Field::new(padded.nodes());
        for (x, y) in places(padded.nodes()) {
            let (hx, hy) = plan.grid.home_node(level, x, y);
            let block = near.at(((hx / SIDE).min(w / SIDE - 1), (hy / SIDE).min(h / SIDE - 1)));
            base_nodes.put(x, y, block.base.nodes.at(hx, hy));
            mip.put(x, y, block.base.mip.as_ref().unwrap_or(&block.base.nodes).at(hx, hy));
            filled.put(x, y, block.filled.at(hx, hy));
        }
        let (mut intervals, mut extremes, mut centres) = (Field::new(padded), Field::new(core), Field::new(padded));
        for (x, y) in places(padded) {
            let (hx, hy) = plan.grid.home_cell(level, x, y);
            let Some(below) = &near.at((hx / SIDE, hy / SIDE)).base.below else { continue };
            intervals.put(x, y, below.intervals.at(hx, hy));
            centres.put(x, y, below.centres.at(hx, hy));
            if core.contains(&Window::new(x, y, 1, 1)) {
                extremes.put(x, y, below.extremes.at(hx, hy));
            }
        }
        let made_up: HashSet<(i32, i32)> =
            blocks.keys().copied().filter(|key| !self.blocks.contains_key(key)).collect();
        if !made_up.is_empty() {
            let last = Cell::new(((-1, -1), false));
            raise_interpolated(&mut centres, &base_nodes, self.rounding(), |x, y| {
                let (x, y) = plan.grid.home_cell(level, x, y);
                let key = (x / SIDE, y / SIDE);
                if last.get().0 != key {
                    last.set((key, made_up.contains(&key)));
                }
                last.get().1
            });
        }
        let below = Below {
            intervals,
            extremes,
            centres,
            distances: (0..DISTANCE_LEVELS)
                .map(|i| {
                    let up = i + 1;
                    let window =
                        Window::between(padded.x0 >> up, padded.x1() >> up, padded.y0 >> up, padded.y1() >> up);
                    Field::from_fn(window, |x, y| {
                        if y < 0 || y >= h >> up || (plan.grid.plane && (x < 0 || x >= w >> up)) {
                            return CellDistances::default();
                        }
                        let x = x.rem_euclid(w >> up);
                        let side = SIDE >> up;
                        let block = &near.at((x / side, y / side)).base.below;
                        block.as_ref().map_or_else(CellDistances::default, |b| b.distances[i].at(x, y))
                    })
                })
                .collect(),
        };
        Ok((Base { level, nodes: base_nodes, mip: Some(mip), below: Some(below) }, filled))
    }

    /// All blocks that a padded window touches, over seam and poles.
    fn around(&self, padded: Window) -> Result<HashMap<(i32, i32), Arc<Handoff>>, ToolError> {
        let grid = &self.composer.plan.grid;
        let mut blocks = HashMap::new();
        // A step of a block from the padded corner on, and the far edge, meet every block.
        let steps = |from: i32, to: i32| (from..to).step_by(SIDE as usize).chain([to]);
        for y in steps(padded.y0, padded.y1()) {
            for x in steps(padded.x0, padded.x1()) {
                for (x, y) in [(x, y), (x - 1, y), (x, y - 1), (x - 1, y - 1)] {
                    let (x, y) = grid.home_cell(self.level, x, y);
                    let key = (x / SIDE, y / SIDE);
                    if let Entry::Vacant(place) = blocks.entry(key) {
                        place.insert(match self.blocks.get(&key) {
                            Some(block) => Arc::clone(block),
                            None => Arc::new(self.made_up(key)?),
                        });
                    }
                }
            }
        }
        Ok(blocks)
    }

    /// Each level of interpolation rounds by at most half a step: 8 sixteenths.
    fn rounding(&self) -> i32 {
        8 * self.level as i32
    }

    /// The summary of a block that has no tiles: below this level its nodes are interpolated. The
    /// codes of its centres depend on its neighbours and are left at 0.
    fn made_up(&self, (bx, by): (i32, i32)) -> Result<Handoff, ToolError> {
        let core = Window::new(bx * SIDE, by * SIDE, SIDE as usize, SIDE as usize);
        let composed = self.composer.window(self.level, core.nodes())?;
        let nodes = composed.q;
        let corners = |x, y| [nodes.at(x, y), nodes.at(x + 1, y), nodes.at(x, y + 1), nodes.at(x + 1, y + 1)];
        let rounding = self.rounding();
        let intervals = Field::from_fn(core, |x, y| {
            let c = corners(x, y);
            let range = |f: fn(i32, i32) -> i32| c.iter().copied().reduce(f).unwrap_or(c[0]);
            let (min, max) = (range(i32::min), range(i32::max));
            let rounding = if min == max { 0 } else { rounding };
            Interval { lo: -rounding, hi: rounding, min, max }
        });
        let extremes = Field::from_fn(core, |x, y| {
            let c = corners(x, y);
            c.iter().fold(Extremes { min: c[0], max: c[0] }, |e, &q| Extremes { min: e.min.min(q), max: e.max.max(q) })
        });
        let distances = (0..DISTANCE_LEVELS)
            .map(|i| {
                let up = i + 1;
                let window = Window::new(core.x0 >> up, core.y0 >> up, core.nx >> up, core.ny >> up);
                let sources = Sources {
                    nodes: &nodes,
                    intervals: Some(&intervals),
                    children: None,
                    span: i as u32,
                    distances: None,
                };
                cell_distances(&sources, window)
            })
            .collect();
        let below = Below { intervals, extremes, centres: Field::new(core), distances };
        let base = Base { level: self.level, mip: Some(nodes.clone()), nodes, below: Some(below) };
        Ok(Handoff { base, filled: composed.filled })
    }
}

/// All places of a window, row by row.
fn places(window: Window) -> impl Iterator<Item = (i32, i32)> {
    (window.y0..window.y1()).flat_map(move |y| (window.x0..window.x1()).map(move |x| (x, y)))
}

/// Blocks asked for cell by cell along rows: mostly it is the last one again.
struct Near<'a> {
    blocks: &'a HashMap<(i32, i32), Arc<Handoff>>,
    last: Cell<Option<((i32, i32), &'a Handoff)>>,
}

impl<'a> Near<'a> {
    fn at(&self, key: (i32, i32)) -> &'a Handoff {
        match self.last.get() {
            Some((last, block)) if last == key => block,
            _ => {
                let block = &*self.blocks[&key];
                self.last.set(Some((key, block)));
                block
            }
        }
    }
}
