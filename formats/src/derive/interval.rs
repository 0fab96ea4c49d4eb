//! How far S_0 may lie from S_k, the bilinear surface over every 2^k-th node.
//!
//! A deviation of level k is measured on the nodes of a level g below it; what those nodes do not
//! show of S_0 is held by one interval for each cell of level g.

use multiversion::multiversion;

use super::code::MAX_SIXTEENTHS;
use super::field::{Field, Window};
use super::parted::Parted;

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
    let mut rows = [Parted::default(), Parted::default(), Parted::default()];
    let zeros = vec![Interval::default(); need.nx];
    for (j, out) in (0..).zip(out.chunks_exact_mut(window.nx)) {
        let y = need.y0 + 2 * j;
        rows.rotate_left(2);
        let known = usize::from(j > 0);
        for (dy, row) in (0..).zip(&mut rows).skip(known) {
            row.take(nodes.row(y + dy, need.x0, need.nx + 1));
        }
        let inner = [0, 1].map(|d| finer.map_or(&zeros[..], |f| f.row(y + d, need.x0, need.nx)));
        cells(&rows, inner, out);
    }
}

/// A row of cells, from three rows of nodes and two of finer cells.
#[multiversion(targets("x86_64+avx2"))]
fn cells(rows: &[Parted; 3], finer: [&[Interval]; 2], out: &mut [Interval]) {
    let n = out.len();
    let [h_sw, h_w, h_nw] = [&rows[0].even[..n], &rows[1].even[..n], &rows[2].even[..n]];
    let [h_se, h_e, h_ne] = [&rows[0].even[1..=n], &rows[1].even[1..=n], &rows[2].even[1..=n]];
    let [h_s, h_c, h_n] = [&rows[0].odd[..n], &rows[1].odd[..n], &rows[2].odd[..n]];
    let finer = finer[0].chunks_exact(2).zip(finer[1].chunks_exact(2));
    for (i, (out, (below, above))) in out.iter_mut().zip(finer).enumerate() {
        let centre = 16 * h_c[i] - 4 * (h_sw[i] + h_se[i] + h_nw[i] + h_ne[i]);
        let south = 16 * h_s[i] - 8 * (h_sw[i] + h_se[i]);
        let north = 16 * h_n[i] - 8 * (h_nw[i] + h_ne[i]);
        let west = 16 * h_w[i] - 8 * (h_sw[i] + h_nw[i]);
        let east = 16 * h_e[i] - 8 * (h_se[i] + h_ne[i]);
        let (low, high) = (centre.min(0), centre.max(0));
        let lo = (below[0].lo + south.min(west).min(low))
            .min(below[1].lo + south.min(east).min(low))
            .min(above[0].lo + north.min(west).min(low))
            .min(above[1].lo + north.min(east).min(low));
        let hi = (below[0].hi + south.max(west).max(high))
            .max(below[1].hi + south.max(east).max(high))
            .max(above[0].hi + north.max(west).max(high))
            .max(above[1].hi + north.max(east).max(high));
        // Both surfaces stay within +-2^24 units, so a bound need never exceed their distance;
        // this also keeps sums of intervals and residuals within an i32.
        *out = Interval { lo: lo.max(-MAX_SIXTEENTHS), hi: hi.min(MAX_SIXTEENTHS) };
    }
}
