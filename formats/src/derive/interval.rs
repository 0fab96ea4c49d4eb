//! How far S_0 may lie from S_k, the bilinear surface over every 2^k-th node.
//!
//! A deviation of level k is measured on the nodes of a level g below it; what those nodes do not
//! show of S_0 is held by one interval for each cell of level g.

use multiversion::multiversion;

use super::field::{Field, Window};
use super::interval_wide::wide;
use super::lanes::SPAN;
use super::parted::Parted;

/// Bounds of S_0 and of S_0 - S_k over a cell of level k, the latter in sixteenths of a height unit (there they are
/// exact integers from level to level: S_{k-1} - S_k takes halves and quarters).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Interval {
    /// Lower bound, at most 0: both surfaces share the cell's corners.
    pub lo: i32,
    /// Upper bound, at least 0.
    pub hi: i32,
    /// The least height of S_0 in the cell, in height units.
    pub min: i32,
    /// The greatest.
    pub max: i32,
}

/// I_k for each cell of `window`, cells of level k, from nodes and intervals of level k - `span`
/// (`None`: level 0, whose intervals are all 0). On each of the finer cells the two levels' surfaces
/// differ by a bilinear function, so by no more than at the corners, and S_0 adds the finer
/// interval. Rounded outwards to whole sixteenths.
///
/// # Panics
/// When `span` is not 1 to 3, `out` has not the window's length, or a finer node or cell is
/// missing.
pub fn intervals_into(
    nodes: &Field<i32>,
    finer: Option<&Field<Interval>>,
    span: u32,
    window: Window,
    out: &mut [Interval],
) {
    assert!((1..=SPAN).contains(&span), "nodes 1 to {SPAN} levels below");
    assert_eq!(out.len(), window.len(), "one value for each cell");
    if window.is_empty() {
        return;
    }
    let need = Window::new(window.x0 << span, window.y0 << span, window.nx << span, window.ny << span);
    assert!(nodes.window().contains(&need.nodes()), "the nodes of the cells are {:?}", need.nodes());
    assert!(finer.is_none_or(|f| f.window().contains(&need)), "the finer cells are {need:?}");
    if span > 1 || finer.is_some() {
        return wide(nodes, finer, span, window, out);
    }
    let mut rows = [Parted::default(), Parted::default(), Parted::default()];
    for (j, out) in (0..).zip(out.chunks_exact_mut(window.nx)) {
        let y = need.y0 + 2 * j;
        rows.rotate_left(2);
        let known = usize::from(j > 0);
        for (dy, row) in (0..).zip(&mut rows).skip(known) {
            row.take(nodes.row(y + dy, need.x0, need.nx + 1));
        }
        cells(&rows, out);
    }
}

/// A row of cells of level 1 from three rows of nodes.
#[multiversion(targets("x86_64+avx2"))]
fn cells(rows: &[Parted; 3], out: &mut [Interval]) {
    let n = out.len();
    let [h_sw, h_w, h_nw] = [&rows[0].even[..n], &rows[1].even[..n], &rows[2].even[..n]];
    let [h_se, h_e, h_ne] = [&rows[0].even[1..=n], &rows[1].even[1..=n], &rows[2].even[1..=n]];
    let [h_s, h_c, h_n] = [&rows[0].odd[..n], &rows[1].odd[..n], &rows[2].odd[..n]];
    for i in 0..n {
        let centre = 16 * h_c[i] - 4 * (h_sw[i] + h_se[i] + h_nw[i] + h_ne[i]);
        let south = 16 * h_s[i] - 8 * (h_sw[i] + h_se[i]);
        let north = 16 * h_n[i] - 8 * (h_nw[i] + h_ne[i]);
        let west = 16 * h_w[i] - 8 * (h_sw[i] + h_nw[i]);
        let east = 16 * h_e[i] - 8 * (h_se[i] + h_ne[i]);
        let low = h_sw[i].min(h_s[i]).min(h_se[i]).min(h_w[i]).min(h_e[i]);
        let high = h_sw[i].max(h_s[i]).max(h_se[i]).max(h_w[i]).max(h_e[i]);
        out[i] = Interval {
            lo: centre.min(south).min(north).min(west).min(east).min(0),
            hi: centre.max(south).max(north).max(west).max(east).max(0),
            min: low.min(h_c[i]).min(h_nw[i]).min(h_n[i]).min(h_ne[i]),
            max: high.max(h_c[i]).max(h_nw[i]).max(h_n[i]).max(h_ne[i]),
        };
    }
}
