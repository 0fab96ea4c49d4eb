//! Whether a node is active, that is whether the triangles it halves are bisected.
//!
//! The answer depends on the node alone, so both triangles get the same one; and an active node's
//! parents are active, so the mesh conforms without looking at neighbours: usability and errors
//! are saturated, regions nested, and each comparison monotone in what it compares.
//!
//! An inactive node's triangles may be drawn, flat between corners on S_0. A point of S_0 over them
//! is at most e away from them:
//! - along the normal, the deviation;
//! - for the bulge of E + h n over a flat triangle, max |D^2| / 2 times the square of half the
//!   hypotenuse (the sum of squared distances to the corners, weighted as the point is, is at
//!   most the circle's radius squared);
//! - for normals that differ across heights that differ, half the heights' range times the turn.
//!
//! Seen at distance r, at the angle alpha from the axis, that is at most
//! f e / (cos alpha (r cos alpha - e)) pixels.

use super::params::{Params, SLACK};
use super::region::Region;
use super::triangle::Node;
use super::virtual_cells::{VirtualCells, virtual_cells};
use crate::pages::{NONE, Pages, SLOT_MASK, USABLE};
use crate::planet::View;

/// What a node says to a triangle that asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Where its subtree lies.
    pub region: Region,
    /// True when the triangle is to be bisected.
    pub active: bool,
}

/// Level of a node; below 0 inside level-0 cells.
#[must_use]
pub fn level(pages: &Pages<'_>, node: &Node) -> i32 {
    node.exponent as i32 - (31 - pages.planet.m as i32)
}

/// Tiles that must be usable for a node to be active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Holders {
    /// The node's level, or the nearest that is stored.
    pub level: u32,
    /// First and last column; on a globe the first may be the greater one.
    pub x: [u32; 2],
    /// First and last row.
    pub y: [u32; 2],
}

/// The tiles that hold a node.
///
/// Below level 0 the tiles within 2 cells, less the subtree's reach: so a node needs all that its
/// parents need, up to a level-0 side's midpoint, which needs the tiles on which it lies.
#[must_use]
pub fn holders(pages: &Pages<'_>, node: &Node) -> Holders {
    let planet = pages.planet;
    let signed = level(pages, node);
    let level = (signed.max(0) as u32).min(planet.root_level);
    let cell_shift = 31 - planet.m;
    let reach = if signed < 0 { (2 << cell_shift) - node.subtree_half_width() } else { 0 };
    let shift = cell_shift + level + 8;
    let (mut west, mut east) = (node.s.wrapping_sub(reach).wrapping_sub(1), node.s.wrapping_add(reach));
    if planet.plane != 0 {
        (west, east) = (node.s - node.s.min(reach + 1), east.min((1 << 31) - 1));
    }
    let (south, north) = (node.t - node.t.min(reach + 1), (node.t + reach).min((1 << 31) - 1));
    Holders { level, x: [west >> shift, east >> shift], y: [south >> shift, north >> shift] }
}

/// True when all pages that hold the node are usable.
#[must_use]
pub fn usable(pages: &Pages<'_>, node: &Node) -> bool {
    let tiles = holders(pages, node);
    let is = |x: usize, y: usize| {
        let page = pages.find(tiles.level, tiles.x[x], tiles.y[y]);
        page != NONE && page & USABLE != 0
    };
    let (two_x, two_y) = (tiles.x[1] != tiles.x[0], tiles.y[1] != tiles.y[0]);
    is(0, 0) && (!two_x || is(1, 0)) && (!two_y || is(0, 1)) && (!two_x || !two_y || is(1, 1))
}

/// Saturated deviation of a node, metres, at most the planet's range of heights. Pages of the
/// coarsest level have those of the levels above it.
#[must_use]
pub fn deviation_m(pages: &Pages<'_>, params: &Params, node: &Node, cells: Option<&VirtualCells>) -> f32 {
    if let Some(cells) = cells {
        return cells.deviation_m.min(params.range_m);
    }
    let level = (level(pages, node) as u32).min(pages.planet.root_level);
    let at = pages.place(level, node.s, node.t);
    let page = pages.find(level, at.x, at.y);
    if page == NONE {
        return params.range_m;
    }
    pages.deviation_m(page & SLOT_MASK, at.column, at.row).min(params.range_m)
}

/// What S_0 may be off the flat triangles of an inactive node, metres.
#[must_use]
pub fn error_m(params: &Params, node: &Node, region: &Region, deviation_m: f32) -> f32 {
    let half = node.half_hypotenuse();
    let bulge = params.curvature_m * (half * half);
    let lean = params.turn_rad * half * region.half_range_m;
    deviation_m + (bulge + lean)
}

/// True when an error of `error_m` anywhere in the region may be seen.
#[must_use]
pub fn may_show(view: &View, params: &Params, node: &Node, region: &Region, error_m: f32) -> bool {
    let [x, y, z] = along_axes(view, region.centre_m);
    let radius = region.radius_m(params, node.subtree_radius());
    let nearest = region.distance_m - radius;
    let mut cos = params.cos_corner;
    let mut depth = view.forward[3];
    if nearest > 0.0 {
        // The ball's points lie at most its own angle further off the axis than its centre.
        let (sin_ball, cos_off) = (radius / region.distance_m, z / region.distance_m);
        let sin_off = (x * x + y * y).sqrt() / region.distance_m;
        let cos_ball = (1.0 - sin_ball * sin_ball).max(0.0).sqrt();
        cos = cos.max(cos_off * cos_ball - sin_off * sin_ball);
        depth = depth.max((z - radius).max(nearest * cos));
    }
    let slack = 1.0 + 2.0 * SLACK * (node.rank() + 1) as f32;
    view.right[3] * error_m * slack > view.up[3] * ((depth - error_m) * cos)
}

/// Components to the right, up and along the axis of sight.
#[must_use]
pub fn along_axes(view: &View, v: [f32; 3]) -> [f32; 3] {
    [view.right, view.up, view.forward].map(|axis| axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2])
}

/// Judges a node on behalf of a triangle whose parent is `parent`. Pages that are used or lacking
/// are asked for.
#[must_use]
pub fn judge(pages: &Pages<'_>, view: &View, params: &Params, node: &Node, parent: &Node) -> Judgement {
    let around = |n: &Node| (level(pages, n) < 0).then(|| virtual_cells(pages, n));
    let usable = usable(pages, node);
    let cells = around(node);
    // Cells that are not usable say nothing of slopes.
    let region = Region::of(pages, view, params, node, cells.as_ref().filter(|_| usable));
    let deviation = if usable {
        deviation_m(pages, params, node, cells.as_ref())
    } else {
        // The node's own is not known: its parent's bounds it.
        deviation_m(pages, params, parent, around(parent).as_ref())
    };
    let error = error_m(params, node, &region, deviation);
    let active = may_show(view, params, node, &region, error);
    if usable || active {
        ask(pages, node);
    }
    Judgement { region, active: active && usable }
}

/// Asks for the pages that hold a node.
fn ask(pages: &Pages<'_>, node: &Node) {
    let tiles = holders(pages, node);
    for y in 0..=usize::from(tiles.y[1] != tiles.y[0]) {
        for x in 0..=usize::from(tiles.x[1] != tiles.x[0]) {
            pages.ask(tiles.level, tiles.x[x], tiles.y[y]);
        }
    }
}
