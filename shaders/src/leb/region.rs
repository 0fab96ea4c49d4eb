//! Where all that may be drawn under a node lies: an interval of heights, and a ball.
//!
//! Both are nested: a child's lies within its parent's, in the real numbers by construction and
//! in f32 by the slack. The pages' part in this: an H_ext interval lies within that of the
//! coarser block around it (residency establishes it; files round each outwards by itself).

use super::params::{Params, SLACK};
use super::triangle::Node;
use super::virtual_cells::VirtualCells;
use crate::pages::{BLOCKS, NONE, Pages, SLOT_MASK};
use crate::planet::View;
use crate::position::camera_relative_m;

/// A node's surroundings in the frame of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The node at the middle of the interval, metres.
    pub centre_m: [f32; 3],
    /// Distance of `centre_m` from the camera, metres.
    pub distance_m: f32,
    /// Half the interval of heights, with slack, metres.
    pub half_range_m: f32,
    /// Slack that positions and heights need at this rank, metres.
    pub slack_m: f32,
}

impl Region {
    /// The region of a node; `cells` is what lies around a node below level 0.
    #[must_use]
    pub fn of(pages: &Pages<'_>, view: &View, params: &Params, node: &Node, cells: Option<&VirtualCells>) -> Self {
        let rank = (node.rank() + 1) as f32;
        let [mut low, mut high] = interval_m(pages, node);
        if let Some(cells) = cells {
            let height = pages.height_m(0, node.s, node.t);
            let reach = 1.01 * cells.slope * node.subtree_half_width() as f32 + params.slack_m * rank;
            low = low.max(height - reach);
            high = high.min(height + reach);
        }
        let centre_m = camera_relative_m(pages.planet, view, node.s, node.t, 0.5 * (low + high));
        let [x, y, z] = centre_m;
        let distance_m = (x * x + y * y + z * z).sqrt();
        Self {
            centre_m,
            distance_m,
            half_range_m: 0.5 * (high - low),
            slack_m: (SLACK * distance_m + params.slack_m) * rank,
        }
    }

    /// Radius of a ball that holds all of S_0 within so many units of the node, metres.
    #[must_use]
    pub fn radius_m(&self, params: &Params, units: f32) -> f32 {
        params.reach_m * units + self.half_range_m + self.slack_m
    }
}

/// The extremes of S_0 around a node, metres, from the H_ext level whose blocks are 8 steps wide,
/// so that at most 2 x 2 touch its subtree; the finest level for nodes below.
#[must_use]
pub fn interval_m(pages: &Pages<'_>, node: &Node) -> [f32; 2] {
    let planet = pages.planet;
    let whole = [planet.min_m, planet.max_m];
    let cell_shift = 31 - planet.m;
    let level = (node.exponent + 2).saturating_sub(cell_shift);
    if level > planet.root_level {
        return whole;
    }
    let reach = node.subtree_half_width();
    let shift = cell_shift + level + 1;
    let (mut west, mut east) = (node.s.wrapping_sub(reach), node.s.wrapping_add(reach));
    if planet.plane != 0 {
        (west, east) = (node.s - node.s.min(reach), east.min(1 << 31));
    }
    let (south, north) = (node.t - node.t.min(reach), (node.t + reach).min(1 << 31));
    let blocks_x = [west >> shift, east.wrapping_sub(1) >> shift];
    let blocks_y = [south >> shift, (north - 1) >> shift];
    let mut out = [f32::INFINITY, f32::NEG_INFINITY];
    for &y in &blocks_y[usize::from(blocks_y[1] == blocks_y[0])..] {
        for &x in &blocks_x[usize::from(blocks_x[1] == blocks_x[0])..] {
            let [low, high] = block_m(pages, level, x, y);
            out = [out[0].min(low), out[1].max(high)];
        }
    }
    [out[0].max(whole[0]), out[1].min(whole[1])]
}

/// H_ext of a block of a level, metres, or of the finest block around it that there is.
fn block_m(pages: &Pages<'_>, level: u32, x: u32, y: u32) -> [f32; 2] {
    for up in 0..=pages.planet.root_level - level {
        let (x, y) = (x >> up, y >> up);
        let page = pages.find(level + up, x / BLOCKS, y / BLOCKS);
        if page != NONE {
            return pages.extremes_m(page & SLOT_MASK, x % BLOCKS, y % BLOCKS);
        }
    }
    [pages.planet.min_m, pages.planet.max_m]
}

/// True when the camera is surely above the ground: over the greatest height of the finest block
/// there is under it.
#[must_use]
pub fn above_ground(pages: &Pages<'_>, view: &View) -> bool {
    let shift = 32 - pages.planet.m;
    let last = (1 << (pages.planet.m - 1)) - 1;
    let [_, high] = block_m(pages, 0, view.camera_s >> shift, (view.camera_t >> shift).min(last));
    view.camera_h_hi_m > high
}
