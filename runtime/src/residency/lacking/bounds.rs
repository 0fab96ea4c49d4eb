//! Bounds from an interpolated tile's nodes alone.
//!
//! Were all finer nodes exactly bilinear between these, the file's rule for level 0 would hold:
//! the triangles' own deviations, raised to what the twists of the cells leave further below. But
//! each level rounds its new nodes to whole steps, by half a step at most, and never out of the
//! range of the nodes they lie between. So under level k, S_0 and every triangle's corners are
//! within min(k / 2, range of the cell's corners) of the bilinear surface, and a code is raised by
//! twice the largest of these over the cells that the node's subtree touches. Over a flat nothing
//! is added, so that a flat stays a flat.

use relief_formats::derive::deviation::{Sources, deviations};
use relief_formats::derive::virtual_cells::virtual_centres;
use relief_formats::derive::{Field, Window, decode_deviation, encode_deviation};
use relief_formats::tile::{TILE_CELLS, TILE_NODES};

use super::surround::BEYOND;

/// Cells with those beyond each side.
const SIDE: usize = TILE_CELLS as usize + 2 * BEYOND;

/// Codes, 257 x 257, of a tile of `level` below which there is only interpolation, by its nodes
/// with those about it. 0 at (even, even) nodes.
pub(super) fn codes(nodes: &Field<i32>, level: u32) -> Vec<u8> {
    let half = TILE_CELLS as usize / 2;
    let coarse = Window::new(0, 0, half, half);
    let centres = virtual_centres(nodes, coarse.finer_cells().expand(1));
    let sources = Sources { nodes, intervals: None, children: Some(&centres), span: 0, distances: None };
    let mut codes = deviations(&sources, coarse).into_data();
    if level > 0 {
        raise(&mut codes, &rounding(nodes, level));
    }
    codes
}

/// What rounding adds at most in each cell, steps: twice min(level / 2, range).
fn rounding(nodes: &Field<i32>, level: u32) -> Vec<u8> {
    let first = -(BEYOND as i32);
    (0..SIDE as i32)
        .flat_map(|y| {
            let (south, north) = (nodes.row(first + y, first, SIDE + 1), nodes.row(first + y + 1, first, SIDE + 1));
            south.windows(2).zip(north.windows(2)).map(move |(s, n)| {
                let (low, high) = (s[0].min(s[1]).min(n[0]).min(n[1]), s[0].max(s[1]).max(n[0]).max(n[1]));
                (2 * i64::from(high - low)).min(i64::from(level)) as u8
            })
        })
        .collect()
}

/// Raises codes by the largest entry among the cells that a node's subtree touches: within 3 cells
/// of a centre, within 2 of a side's midpoint.
fn raise(codes: &mut [u8], rounding: &[u8]) {
    // Per column of nodes, the largest of each row of cells: of 4 and of 6 cells.
    let widest = |row: &[u8], x: usize, reach: usize| {
        let node = x + BEYOND;
        row[node.saturating_sub(reach)..(node + reach).min(SIDE)].iter().copied().max().unwrap_or(0)
    };
    let across: [Vec<u8>; 2] = [2, 3].map(|reach| {
        rounding.chunks_exact(SIDE).flat_map(|row| (0..TILE_NODES).map(move |x| widest(row, x, reach))).collect()
    });
    for (k, code) in codes.iter_mut().enumerate() {
        let (x, y) = (k % TILE_NODES, k / TILE_NODES);
        if (x | y) & 1 == 0 {
            continue;
        }
        let reach = 2 + (x & y & 1);
        let node = y + BEYOND;
        let steps = (node - reach..node + reach).map(|row| across[reach - 2][row * TILE_NODES + x]).max().unwrap_or(0);
        if steps > 0 {
            *code = encode_deviation((decode_deviation(*code) + f32::from(steps)).next_up());
        }
    }
}
