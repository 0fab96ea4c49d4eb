//! What a stage of the derivation tells the next one: a summary of each block, gathered into
//! padded fields over seam and poles.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use relief_formats::derive::deviation::{CellDistances, Sources, cell_distances};
use relief_formats::derive::extremes::Extremes;
use relief_formats::derive::interval::Interval;
use relief_formats::derive::virtual_cells::raise_interpolated;
use relief_formats::derive::{Base, Below, Field, Window};
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

impl<'a> Summaries<'a> {
    /// Summaries at `level`. Blocks that `blocks` lacks have no tile below it.
    pub fn new(map: &'a Map<'a>, level: u32, side: i32, blocks: HashMap<(i32, i32), Arc<Base>>) -> Self {
        Self { map, level, side, blocks }
    }

    /// Cells of all summaries held.
    pub fn cells(&self) -> u64 {
        self.blocks.len() as u64 * (self.side as u64).pow(2)
    }

    /// The base of a stage over `core`, padded by `pad` cells.
    ///
    /// # Errors
    /// A tile that does not decode.
    pub fn gather(&self, core: Window, pad: i32) -> Result<Base, FormatError> {
        let (map, level) = (self.map, self.level);
        let (w, h) = map.size(level);
        let padded = core.expand(pad);
        let mut mip = Field::new(padded.nodes());
        let mut intervals = Field::new(padded);
        let mut extremes = Field::new(core);
        let mut centres = Field::new(padded);
        let mut distances: Vec<Field<CellDistances>> = (1..=DISTANCE_LEVELS)
            .map(|up| {
                Field::new(Window::between(padded.x0 >> up, padded.x1() >> up, padded.y0 >> up, padded.y1() >> up))
            })
            .collect();
        // Row by row, so that only one row of blocks is held where they are made up.
        let mut near = Near { summaries: self, row: None, held: HashMap::new(), last: None };
        for y in padded.y0..=padded.y1() {
            for x in padded.x0..=padded.x1() {
                let (hx, hy) = map.grid.home_node(level, x, y);
                let base = near.at(hx.min(w - 1), hy.min(h - 1))?;
                mip.put(x, y, base.mip.as_ref().unwrap_or(&base.nodes).at(hx, hy));
            }
            if y == padded.y1() {
                break;
            }
            for x in padded.x0..padded.x1() {
                let (hx, hy) = map.grid.home_cell(level, x, y);
                let Some(below) = &near.at(hx, hy)?.below else { continue };
                intervals.put(x, y, below.intervals.at(hx, hy));
                centres.put(x, y, below.centres.at(hx, hy));
                if core.contains(&Window::new(x, y, 1, 1)) {
                    extremes.put(x, y, below.extremes.at(hx, hy));
                }
            }
            for (up, field) in (1..).zip(&mut distances) {
                // No triangle lies beyond a pole or a plane's edge: 0 there.
                if y.trailing_zeros() < up || !(0..h).contains(&y) || (y >> up) >= field.window().y1() {
                    continue;
                }
                for x in field.window().x0..field.window().x1() {
                    let inside = (0..w >> up).contains(&x);
                    if inside || !map.grid.plane {
                        let (hx, hy) = (x.rem_euclid(w >> up), y >> up);
                        let below = near.at(hx << up, hy << up)?.below.as_ref();
                        let known = below.and_then(|below| below.distances.get(up as usize - 1));
                        field.put(x, hy, known.map_or_else(CellDistances::default, |known| known.at(hx, hy)));
                    }
                }
            }
        }
        let nodes = map.nodes(level, padded.nodes())?;
        if !map.is_dense() {
            raise_interpolated(&mut centres, &nodes, self.rounding(), |x, y| {
                let (x, y) = map.grid.home_cell(level, x, y);
                !self.blocks.contains_key(&(x / self.side, y / self.side))
            });
        }
        let below = Below { intervals, extremes, centres, distances };
        Ok(Base { level, nodes, mip: Some(mip), below: Some(below) })
    }

    /// Each level of interpolation rounds by at most half a step: 8 sixteenths.
    fn rounding(&self) -> i32 {
        8 * self.level as i32
    }

    /// The summary of a block below which there is nothing but interpolation. The codes of its
    /// centres depend on its neighbours and are left at 0.
    fn interpolated(&self, (x, y): (i32, i32)) -> Result<Base, FormatError> {
        let side = self.side as usize;
        let core = Window::new(x * self.side, y * self.side, side, side);
        let nodes = self.map.nodes(self.level, core.nodes())?;
        let corners = |x, y| [nodes.at(x, y), nodes.at(x + 1, y), nodes.at(x, y + 1), nodes.at(x + 1, y + 1)];
        let range = |c: [i32; 4]| {
            c.iter().fold(Extremes { min: c[0], max: c[0] }, |e, &q| Extremes { min: e.min.min(q), max: e.max.max(q) })
        };
        let rounding = self.rounding();
        let intervals = Field::from_fn(core, |x, y| {
            let Extremes { min, max } = range(corners(x, y));
            let rounding = if min == max { 0 } else { rounding };
            Interval { lo: -rounding, hi: rounding, min, max }
        });
        let extremes = Field::from_fn(core, |x, y| range(corners(x, y)));
        let distances = (0..DISTANCE_LEVELS).map(|index| {
            let up = index + 1;
            let window = Window::new(core.x0 >> up, core.y0 >> up, core.nx >> up, core.ny >> up);
            let sources =
                Sources { nodes: &nodes, intervals: Some(&intervals), children: None, span: index, distances: None };
            cell_distances(&sources, window)
        });
        let distances = distances.collect();
        let below = Below { intervals, extremes, centres: Field::new(core), distances };
        Ok(Base { level: self.level, mip: Some(nodes.clone()), nodes, below: Some(below) })
    }
}

/// The summaries of one row of blocks.
struct Near<'a> {
    summaries: &'a Summaries<'a>,
    row: Option<i32>,
    held: HashMap<i32, Arc<Base>>,
    /// The block asked for last: mostly it is the next one, too.
    last: Option<((i32, i32), Arc<Base>)>,
}

impl Near<'_> {
    /// The summary that holds cell (x, y) of the map.
    fn at(&mut self, x: i32, y: i32) -> Result<&Base, FormatError> {
        let side = self.summaries.side;
        let at = (x / side, y / side);
        let base = match self.last.take() {
            Some((last, base)) if last == at => base,
            _ => self.find(at)?,
        };
        Ok(&self.last.insert((at, base)).1)
    }

    fn find(&mut self, at: (i32, i32)) -> Result<Arc<Base>, FormatError> {
        if self.row != Some(at.1) {
            self.row = Some(at.1);
            self.held.clear();
        }
        Ok(match self.held.entry(at.0) {
            Entry::Occupied(held) => Arc::clone(held.get()),
            Entry::Vacant(free) => Arc::clone(free.insert(match self.summaries.blocks.get(&at) {
                Some(block) => Arc::clone(block),
                None => Arc::new(self.summaries.interpolated(at)?),
            })),
        })
    }
}
