//! What a stage of the derivation tells the next one: a summary of each block, gathered into
//! padded fields over seam and poles.

use std::collections::HashMap;
use std::sync::Arc;

use relief_formats::derive::deviation::{CellDistances, Sources, cell_distances};
use relief_formats::derive::extremes::Extremes;
use relief_formats::derive::interval::Interval;
use relief_formats::derive::{Base, Below, Field, Window, encode_deviation};
use relief_formats::file::FormatError;

use super::map::Map;

/// Levels whose distances come from the stage below.
const DISTANCE_LEVELS: u32 = 3;

/// Summaries at the level where a stage starts, by block of `side` x `side` cells.
pub(super) struct Summaries<'a> {
    map: &'a Map<'a>,
    level: u32,
    side: i32,
    blocks: HashMap<(i32, i32), Arc<Base>>,
}

/// The summaries that a window needs.
type Near = HashMap<(i32, i32), Arc<Base>>;

impl<'a> Summaries<'a> {
    /// Summaries at `level`. Blocks that `blocks` lacks have no tile below it.
    pub fn new(map: &'a Map<'a>, level: u32, side: i32, blocks: HashMap<(i32, i32), Arc<Base>>) -> Self {
        Self { map, level, side, blocks }
    }

    /// The base of a stage over `core`, padded by `pad` cells.
    ///
    /// # Errors
    /// A tile that does not decode.
    pub fn gather(&self, core: Window, pad: i32) -> Result<Base, FormatError> {
        let (map, level, side) = (self.map, self.level, self.side);
        let (w, h) = map.size(level);
        let padded = core.expand(pad);
        let near = self.near(padded)?;
        let mip = Field::from_fn(padded.nodes(), |x, y| {
            let (x, y) = map.home_node(level, x, y);
            let block = near.get(&((x / side).min(w / side - 1), (y / side).min(h / side - 1)));
            block.map_or(0, |base| base.mip.as_ref().unwrap_or(&base.nodes).at(x, y))
        });
        let below = |x: i32, y: i32| {
            let (x, y) = map.home_cell(level, x, y);
            let block = near.get(&(x / side, y / side)).and_then(|base| base.below.as_ref());
            (block, x, y)
        };
        let intervals = Field::from_fn(padded, |x, y| match below(x, y) {
            (Some(below), x, y) => below.intervals.at(x, y),
            _ => Interval::default(),
        });
        let extremes = Field::from_fn(core, |x, y| match below(x, y) {
            (Some(below), x, y) => below.extremes.at(x, y),
            _ => Extremes::default(),
        });
        let centres = Field::from_fn(padded, |x, y| match below(x, y) {
            (Some(below), x, y) => below.centres.at(x, y),
            _ => 0,
        });
        let distances = (0..DISTANCE_LEVELS as usize).map(|index| {
            let up = index + 1;
            let (w, h, side) = (w >> up, h >> up, side >> up);
            let window = Window::between(padded.x0 >> up, padded.x1() >> up, padded.y0 >> up, padded.y1() >> up);
            Field::from_fn(window, |x, y| {
                // No triangle lies beyond a pole or a plane's edge.
                if !(0..h).contains(&y) || map.grid.plane && !(0..w).contains(&x) {
                    return CellDistances::default();
                }
                let x = x.rem_euclid(w);
                let below = near.get(&(x / side, y / side)).and_then(|base| base.below.as_ref());
                below.and_then(|below| below.distances.get(index)).map_or_else(CellDistances::default, |field| field.at(x, y))
            })
        });
        let below = Below { intervals, extremes, centres, distances: distances.collect() };
        Ok(Base { level, nodes: map.nodes(level, padded.nodes())?, mip: Some(mip), below: Some(below) })
    }

    /// All blocks that a padded window touches.
    fn near(&self, padded: Window) -> Result<Near, FormatError> {
        let steps = |from: i32, to: i32| (from..to).step_by(self.side as usize).chain([to]);
        let mut near = Near::new();
        for (x, y) in steps(padded.y0, padded.y1()).flat_map(|y| steps(padded.x0, padded.x1()).map(move |x| (x, y))) {
            // The cells around a node, for it may lie on a block's border.
            for (x, y) in [(x, y), (x - 1, y), (x, y - 1), (x - 1, y - 1)] {
                let (x, y) = self.map.home_cell(self.level, x, y);
                let at = (x / self.side, y / self.side);
                if !near.contains_key(&at) {
                    let block = match self.blocks.get(&at) {
                        Some(block) => Arc::clone(block),
                        None => Arc::new(self.interpolated(at)?),
                    };
                    near.insert(at, block);
                }
            }
        }
        Ok(near)
    }

    /// The summary of a block below which there is nothing but interpolation.
    fn interpolated(&self, (x, y): (i32, i32)) -> Result<Base, FormatError> {
        let side = self.side as usize;
        let core = Window::new(x * self.side, y * self.side, side, side);
        let nodes = self.map.nodes(self.level, core.nodes())?;
        let corners = |x, y| [nodes.at(x, y), nodes.at(x + 1, y), nodes.at(x, y + 1), nodes.at(x + 1, y + 1)];
        let range = |c: [i32; 4]| c.iter().fold(Extremes { min: c[0], max: c[0] }, |e, &q| Extremes { min: e.min.min(q), max: e.max.max(q) });
        let flat = |c: [i32; 4]| c.iter().all(|&q| q == c[0]);
        // Each level of interpolation rounds by at most half a step: 8 sixteenths.
        let rounding = 8 * self.level as i32;
        let intervals = Field::from_fn(core, |x, y| {
            let Extremes { min, max } = range(corners(x, y));
            let rounding = if min == max { 0 } else { rounding };
            Interval { lo: -rounding, hi: rounding, min, max }
        });
        let extremes = Field::from_fn(core, |x, y| range(corners(x, y)));
        // A bilinear cell bulges from its two triangles by a quarter of its twist at most.
        let centres = Field::from_fn(core, |x, y| {
            let c = corners(x, y);
            let twist = (c[0] + c[3] - c[1] - c[2]).abs() as f32 / 4.0;
            if flat(c) { 0 } else { encode_deviation(twist + rounding as f32 / 8.0) }
        });
        let distances = (0..DISTANCE_LEVELS).map(|index| {
            let up = index + 1;
            let window = Window::new(core.x0 >> up, core.y0 >> up, core.nx >> up, core.ny >> up);
            let sources = Sources { nodes: &nodes, intervals: Some(&intervals), children: None, span: index, distances: None };
            cell_distances(&sources, window)
        });
        let distances = distances.collect();
        let below = Below { intervals, extremes, centres, distances };
        Ok(Base { level: self.level, mip: Some(nodes.clone()), nodes, below: Some(below) })
    }
}
