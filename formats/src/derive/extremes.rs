//! H_ext: extremes of S_0 over the cells of a level.
//!
//! S_0 is bilinear in each level-0 cell, so the extremes of its nodes, border included, are its
//! own. A field of level k has an entry for each cell of level k + 1 (paper 000, section 3.1).

use multiversion::multiversion;

use super::field::{Field, Window};

/// The least and greatest height of S_0 over a cell, in height units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extremes {
    /// Least.
    pub min: i32,
    /// Greatest.
    pub max: i32,
}

/// Level 0: extremes of 3 x 3 nodes for each cell of `window`, cells of level 1.
///
/// # Panics
/// When `out` has not the window's length or `nodes` lacks a node of its cells.
pub fn extremes_from_nodes(nodes: &Field<i32>, window: Window, out: &mut [Extremes]) {
    assert_eq!(out.len(), window.len(), "one value for each cell");
    if window.is_empty() {
        return;
    }
    let need = window.finer_cells().nodes();
    assert!(nodes.window().contains(&need), "the nodes of the cells are {need:?}");
    let mut low = vec![0; need.nx];
    let mut high = vec![0; need.nx];
    for (j, out) in (0..).zip(out.chunks_exact_mut(window.nx)) {
        let rows = [0, 1, 2].map(|d| nodes.row(need.y0 + 2 * j + d, need.x0, need.nx));
        node_row(rows, &mut low, &mut high, out);
    }
}

/// Level k >= 1: extremes of the 2 x 2 `finer` entries of level k - 1 for each cell of `window`,
/// cells of level k + 1.
///
/// # Panics
/// When `out` has not the window's length or `finer` lacks one of the cells.
pub fn extremes_next(finer: &Field<Extremes>, window: Window, out: &mut [Extremes]) {
    assert_eq!(out.len(), window.len(), "one value for each cell");
    if window.is_empty() {
        return;
    }
    let need = window.finer_cells();
    assert!(finer.window().contains(&need), "the finer cells are {need:?}");
    for (j, out) in (0..).zip(out.chunks_exact_mut(window.nx)) {
        let south = finer.row(need.y0 + 2 * j, need.x0, need.nx).chunks_exact(2);
        let north = finer.row(need.y0 + 2 * j + 1, need.x0, need.nx).chunks_exact(2);
        for ((out, s), n) in out.iter_mut().zip(south).zip(north) {
            out.min = s[0].min.min(s[1].min).min(n[0].min).min(n[1].min);
            out.max = s[0].max.max(s[1].max).max(n[0].max).max(n[1].max);
        }
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn node_row(rows: [&[i32]; 3], low: &mut [i32], high: &mut [i32], out: &mut [Extremes]) {
    let [a, b, c] = rows;
    for ((((low, high), &a), &b), &c) in low.iter_mut().zip(high.iter_mut()).zip(a).zip(b).zip(c) {
        *low = a.min(b).min(c);
        *high = a.max(b).max(c);
    }
    let low = low.windows(3).step_by(2);
    for ((out, l), h) in out.iter_mut().zip(low).zip(high.windows(3).step_by(2)) {
        *out = Extremes { min: l[0].min(l[1]).min(l[2]), max: h[0].max(h[1]).max(h[2]) };
    }
}
