//! The filtered pyramid: [1 2 1] x [1 2 1] / 16 about every second node.

use multiversion::multiversion;

use super::field::{Field, Window};

/// Nodes of level k + 1 whose filter lies wholly in `window`, nodes of level k.
#[must_use]
pub fn mip_window(window: Window) -> Window {
    let inner = |a: i32, b: i32| ((a + 2) >> 1, (b - 2).div_euclid(2) + 1);
    let (x0, x1) = inner(window.x0, window.x1());
    let (y0, y1) = inner(window.y0, window.y1());
    Window::between(x0, x1, y0, y1)
}

/// Filtered heights of level k + 1 over all of [`mip_window`].
#[must_use]
pub fn mip_next(finer: &Field<i32>) -> Field<i32> {
    let mut out = Field::new(mip_window(finer.window()));
    mip_into(finer, out.window(), out.data_mut());
    out
}

/// Filtered heights of level k + 1 at the nodes of `window`, from those of level k:
/// floor((sum of [1 2 1] x [1 2 1] about (2 i, 2 j) + 8) / 16).
///
/// # Panics
/// When `out` has not the window's length or `finer` lacks a node that the filter reaches.
pub fn mip_into(finer: &Field<i32>, window: Window, out: &mut [i32]) {
    assert_eq!(out.len(), window.len(), "one value for each node");
    if window.is_empty() {
        return;
    }
    let need = Window::new(2 * window.x0 - 1, 2 * window.y0 - 1, 2 * window.nx + 1, 2 * window.ny + 1);
    assert!(finer.window().contains(&need), "the filter's support is {need:?}");
    let mut column = vec![0; need.nx];
    for (j, out) in (0..).zip(out.chunks_exact_mut(window.nx)) {
        let rows = [0, 1, 2].map(|d| finer.row(need.y0 + 2 * j + d, need.x0, need.nx));
        filter_row(rows, &mut column, out);
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn filter_row(rows: [&[i32]; 3], column: &mut [i32], out: &mut [i32]) {
    let [south, middle, north] = rows;
    for (((sum, s), m), n) in column.iter_mut().zip(south).zip(middle).zip(north) {
        *sum = s + 2 * m + n;
    }
    for (out, c) in out.iter_mut().zip(column.windows(3).step_by(2)) {
        *out = (c[0] + 2 * c[1] + c[2] + 8) >> 4;
    }
}
