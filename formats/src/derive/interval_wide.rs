//! [`super::interval`] from nodes several levels below: n = 2^span of their cells to a side.
//!
//! Going down at once is tighter than adding up level by level: the differences of successive
//! levels seldom peak in the same place.

use multiversion::multiversion;

use super::code::MAX_SIXTEENTHS;
use super::field::{Field, Window};
use super::interval::Interval;
use super::lanes::{LANES, Lanes, N, Scratch, spread, spread_intervals};

/// I_k for each cell of `window`, from nodes and intervals of level k - `span`.
pub(super) fn wide(
    nodes: &Field<i32>,
    finer: Option<&Field<Interval>>,
    span: u32,
    window: Window,
    out: &mut [Interval],
) {
    let n = 1usize << span;
    let mut scratch = Scratch::new();
    for (y, out) in (window.y0..).zip(out.chunks_exact_mut(window.nx)) {
        for (x, out) in (window.x0..).step_by(LANES).zip(out.chunks_mut(LANES)) {
            let (gx, gy) = (x << span, y << span);
            for (r, row) in (gy..).zip(&mut scratch.nodes[..=n]) {
                spread(nodes.row(r, gx, out.len() * n + 1), n, row);
            }
            if let Some(finer) = finer {
                for r in 0..n {
                    spread_intervals(finer.row(gy + r as i32, gx, out.len() * n), n, r, &mut scratch);
                }
            }
            let [lo, hi, min, max] = run(&mut scratch, n, finer.is_some());
            for (l, out) in out.iter_mut().enumerate() {
                *out = Interval { lo: lo[l], hi: hi[l], min: min[l], max: max[l] };
            }
        }
    }
}

/// Bounds of each lane's cell, in the order of [`Interval`]'s fields.
#[multiversion(targets("x86_64+avx2"))]
fn run(scratch: &mut Scratch, n: usize, has_intervals: bool) -> [Lanes; 4] {
    let (mut lo, mut hi) = ([0; LANES], [0; LANES]);
    let (mut min, mut max) = (scratch.nodes[0][0], scratch.nodes[0][0]);
    if !has_intervals {
        differences::<false>(scratch, n, [&mut lo, &mut hi, &mut min, &mut max]);
    } else {
        differences::<true>(scratch, n, [&mut lo, &mut hi, &mut min, &mut max]);
        with_intervals(scratch, n, &mut lo, &mut hi);
        for (w, u) in (0..n * n).map(|i| (i / n, i % n)) {
            let (low, high) = (&scratch.min[w][u], &scratch.max[w][u]);
            for l in 0..LANES {
                (min[l], max[l]) = (min[l].min(low[l] >> 4), max[l].max(high[l] >> 4));
            }
        }
    }
    for l in 0..LANES {
        lo[l] = lo[l].max(-MAX_SIXTEENTHS);
        hi[l] = hi[l].min(MAX_SIXTEENTHS);
    }
    [lo, hi, min, max]
}

/// Extremes of 16 (S_g - S_k) and of the heights at the nodes; with `KEEP` also each node's
/// difference, rounded down into `side` and up into `centre`.
#[inline(always)]
fn differences<const KEEP: bool>(scratch: &mut Scratch, n: usize, [lo, hi, min, max]: [&mut Lanes; 4]) {
    let span = n.trailing_zeros();
    let unit = 16 >> span;
    let nodes = &scratch.nodes;
    for w in 0..=n {
        let (mut west, mut whole, mut part) = ([0; LANES], [0; LANES], [0; LANES]);
        let (below, above) = ((n - w) as i32 * unit, w as i32 * unit);
        for l in 0..LANES {
            west[l] = below * nodes[0][0][l] + above * nodes[n][0][l];
            // The slope's integer steps and what is left over, in n-ths.
            let rise = below * nodes[0][n][l] + above * nodes[n][n][l] - west[l];
            whole[l] = rise >> span;
            part[l] = rise & (n as i32 - 1);
        }
        let mut rest = [0; LANES];
        for u in 0..=n {
            let (low, high) = (&mut scratch.side[w][u], &mut scratch.centre[w][u]);
            let h = &nodes[w][u];
            for l in 0..LANES {
                let above = 16 * h[l] - west[l] - (rest[l] >> span);
                let below = 16 * h[l] - west[l] - ((rest[l] + n as i32 - 1) >> span);
                if KEEP {
                    (low[l], high[l]) = (below, above);
                }
                (lo[l], hi[l]) = (lo[l].min(below), hi[l].max(above));
                (min[l], max[l]) = (min[l].min(h[l]), max[l].max(h[l]));
                west[l] += whole[l];
                rest[l] += part[l];
            }
        }
    }
}

/// Adds the finer cells' own intervals to their corners' extremes.
#[inline(always)]
fn with_intervals(scratch: &Scratch, n: usize, lo: &mut Lanes, hi: &mut Lanes) {
    for (w, u) in (0..n * n).map(|i| (i / n, i % n)) {
        let four = |f: &[[Lanes; N + 1]; N + 1]| [f[w][u], f[w][u + 1], f[w + 1][u], f[w + 1][u + 1]];
        let (low, high) = (four(&scratch.side), four(&scratch.centre));
        let (lo_g, hi_g) = (&scratch.lo[w][u], &scratch.hi[w][u]);
        for l in 0..LANES {
            lo[l] = lo[l].min(low[0][l].min(low[1][l]).min(low[2][l]).min(low[3][l]) + lo_g[l]);
            hi[l] = hi[l].max(high[0][l].max(high[1][l]).max(high[2][l]).max(high[3][l]) + hi_g[l]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::interval::intervals_into;
    use super::super::oracle::noise;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_the_narrow_form(seed: u64, bits in 1u32..25, nx in 1usize..40) {
            let window = Window::new(-3, 5, nx, 3);
            let low = 1i64 << (bits - 1);
            let nodes = Field::from_fn(window.finer_cells().nodes(), |x, y| ((noise(x, y, seed) >> (64 - bits)) as i64 - low) as i32);
            let (mut a, mut b) = (vec![Interval::default(); window.len()], vec![Interval::default(); window.len()]);
            wide(&nodes, None, 1, window, &mut a);
            intervals_into(&nodes, None, 1, window, &mut b);
            prop_assert_eq!(a, b);
        }
    }
}
