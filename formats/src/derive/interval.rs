//! How far S_0 may lie from S_k, the bilinear surface over every 2^k-th node.
//!
//! A deviation of level k is measured on the nodes of a level g below it; what those nodes do not
//! show of S_0 is held by one interval for each cell of level g.

use super::code::MAX_SIXTEENTHS;
use super::field::{Field, Window};

/// Bounds of S_0 - S_k over a cell of level k, in sixteenths of a height unit (there they are
/// exact integers: S_{k-1} - S_k takes halves and quarters).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Interval {
    /// Lower bound, at most 0: both surfaces share the cell's corners.
    pub lo: i32,
    /// Upper bound, at least 0.
    pub hi: i32,
}

/// I_k for each cell of `window`, cells of level k, from nodes and intervals of level k - 1
/// (`None`: level 0, whose intervals are all 0). On each of the four finer cells S_{k-1} - S_k is
/// bilinear, so its extremes are those of the corners, and S_0 - S_{k-1} adds its own.
///
/// # Panics
/// When `out` has not the window's length or a finer node or cell is missing.
pub fn interval_next(nodes: &Field<i32>, finer: Option<&Field<Interval>>, window: Window, out: &mut [Interval]) {
    assert_eq!(out.len(), window.len(), "one value for each cell");
    if window.is_empty() {
        return;
    }
    let need = window.finer_cells();
    assert!(nodes.window().contains(&need.nodes()), "the nodes of the cells are {:?}", need.nodes());
    assert!(finer.is_none_or(|f| f.window().contains(&need)), "the finer cells are {need:?}");
    let zeros = vec![Interval::default(); need.nx];
    for (j, out) in (0..).zip(out.chunks_exact_mut(window.nx)) {
        let y = need.y0 + 2 * j;
        let heights = [0, 1, 2].map(|d| nodes.row(y + d, need.x0, need.nx + 1));
        let inner = [0, 1].map(|d| finer.map_or(&zeros[..], |f| f.row(y + d, need.x0, need.nx)));
        for (i, out) in out.iter_mut().enumerate() {
            let x = 2 * i;
            *out = cell(heights.map(|h| [h[x], h[x + 1], h[x + 2]]), inner.map(|f| [f[x], f[x + 1]]));
        }
    }
}

/// One cell from its 3 x 3 finer nodes and 2 x 2 finer cells.
#[inline(always)]
fn cell(h: [[i32; 3]; 3], finer: [[Interval; 2]; 2]) -> Interval {
    let corners = h[0][0] + h[0][2] + h[2][0] + h[2][2];
    let centre = 16 * h[1][1] - 4 * corners;
    let south = 16 * h[0][1] - 8 * (h[0][0] + h[0][2]);
    let north = 16 * h[2][1] - 8 * (h[2][0] + h[2][2]);
    let west = 16 * h[1][0] - 8 * (h[0][0] + h[2][0]);
    let east = 16 * h[1][2] - 8 * (h[0][2] + h[2][2]);
    let quarter = |a: i32, b: i32, f: Interval| {
        let lo = f.lo + a.min(b).min(centre).min(0);
        let hi = f.hi + a.max(b).max(centre).max(0);
        (lo, hi)
    };
    let parts = [
        quarter(south, west, finer[0][0]),
        quarter(south, east, finer[0][1]),
        quarter(north, west, finer[1][0]),
        quarter(north, east, finer[1][1]),
    ];
    // Both surfaces stay within +-2^24 units, so a bound need never exceed their distance; this
    // also keeps sums of intervals and residuals within an i32.
    Interval {
        lo: parts.iter().fold(0, |m, p| m.min(p.0)).max(-MAX_SIXTEENTHS),
        hi: parts.iter().fold(0, |m, p| m.max(p.1)).min(MAX_SIXTEENTHS),
    }
}
