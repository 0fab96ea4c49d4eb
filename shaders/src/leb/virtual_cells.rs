//! Nodes below level 0: midpoints inside and on the sides of level-0 cells, where S_0 is bilinear.
//!
//! A cell with the twist D = |h00 - h10 - h01 + h11| is off the triangles of its centre by D / 4 at
//! most and off those of its sides by D / 16; each level below, a quarter of that. Saturated over
//! all that lies below it, the centre of a sub-cell has the largest of D / 4 of its own cell, D /
//! 16 of the cells beside its sub-cell and D / 64 of those diagonally off, and the midpoint of a
//! side has D / 16 of the two cells that share it and D / 64 of those before and behind them.
//!
//! Cells of pages that are not usable count for nothing: no node in them can be active.

use super::triangle::Node;
use crate::pages::{NONE, Pages, SLOT_MASK, USABLE};

/// What the cells about a node below level 0 say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VirtualCells {
    /// Saturated deviation, metres.
    pub deviation_m: f32,
    /// The greatest slope of S_0 within the node's subtree, metres a unit, by the larger of the
    /// differences in S and T.
    pub slope: f32,
}

/// Sub-cells looked at: those that touch the node's own, or lie along its side.
#[must_use]
pub fn virtual_cells(pages: &Pages<'_>, node: &Node) -> VirtualCells {
    let planet = pages.planet;
    // A sub-cell is 2 steps wide, and 2^fold of them are a cell.
    let shift = node.exponent + 1;
    let cell_shift = 31 - planet.m;
    let fold = cell_shift - shift;
    let (x, y) = (node.s >> shift, node.t >> shift);
    // The side of a cell is vertical where S is even in steps.
    let upright = !node.centre && node.s >> node.exponent & 1 == 0;
    let flat = !node.centre && !upright;
    let (west, south) = (-1, -1);
    let (east, north) = (i32::from(!upright), i32::from(!flat));
    // 4^-(j + 1) or 4^-(j + 2): twice the exponent, as a power of two.
    let base = f32::from_bits((127 - 2 * (fold + 1 + u32::from(!node.centre))) << 23);
    let columns = pages.tiles_x(0) << 8;
    let rows = pages.tiles_y(0) << 8;
    let column_mask = if planet.plane != 0 { u32::MAX } else { (columns << fold).wrapping_sub(1) };
    let cell_of =
        |dx: i32, dy: i32| [(x.wrapping_add(dx as u32) & column_mask) >> fold, y.wrapping_add(dy as u32) >> fold];
    let mut out = VirtualCells::default();
    for dy in south..=north {
        for dx in west..=east {
            // The nearest sub-cell this way: the node's own, or the one on this side of its side.
            let near = [if upright { dx } else { 0 }, if flat { dy } else { 0 }];
            let far = (dx - near[0]).abs() + (dy - near[1]).abs();
            let cell = cell_of(dx, dy);
            if far > 0 && cell == cell_of(near[0], near[1]) || cell[0] >= columns || cell[1] >= rows {
                continue;
            }
            let [twist, slope] = cell_shape(pages, cell);
            let weight = f32::from_bits((127 - 2 * far as u32) << 23);
            out.deviation_m = out.deviation_m.max(twist * (weight * base));
            out.slope = out.slope.max(slope);
        }
    }
    let cell_units = (1u32 << cell_shift) as f32;
    out.slope /= cell_units;
    out
}

/// Twist and greatest slope of a level-0 cell, metres a cell; 0 where its page is not usable.
fn cell_shape(pages: &Pages<'_>, [i, j]: [u32; 2]) -> [f32; 2] {
    let page = pages.find(0, i >> 8, j >> 8);
    if page == NONE || page & USABLE == 0 {
        return [0.0; 2];
    }
    let (slot, column, row) = (page & SLOT_MASK, i & 255, j & 255);
    let (h00, h10) = (pages.node_m(slot, column, row), pages.node_m(slot, column + 1, row));
    let (h01, h11) = (pages.node_m(slot, column, row + 1), pages.node_m(slot, column + 1, row + 1));
    let (south, north) = (h10 - h00, h11 - h01);
    let (west, east) = (h01 - h00, h11 - h10);
    [(north - south).abs(), south.abs().max(north.abs()) + west.abs().max(east.abs())]
}
