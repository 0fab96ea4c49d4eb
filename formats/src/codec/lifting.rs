//! Prediction of a level's new nodes from the coarser level.
//!
//! A square of n x n coarse cells has (n+1)^2 known nodes E. New are the cell centres C (n x n),
//! the midpoints H of horizontal sides (n wide, n+1 high) and V of vertical sides (n+1 wide,
//! n high). C is predicted from E, then H and V from the quincunx of E and C: the four nearest
//! nodes weighted 10/32, the eight of the next ring -1/32. These weights stand for the separable
//! cubic's 81, -9 and 1 over 256 within half a percent of its bytes and need no 64-bit sums.
//! Where the ring leaves the tile the four nearest are averaged; on a tile's own edge the
//! prediction runs along the edge, so it is the same from both sides.

use multiversion::multiversion;

/// One level's new nodes in their three classes, rows south to north.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Classes {
    /// Cell centres, n x n.
    pub c: Vec<i32>,
    /// Midpoints of horizontal sides, n x (n+1).
    pub h: Vec<i32>,
    /// Midpoints of vertical sides, (n+1) x n.
    pub v: Vec<i32>,
}

impl Classes {
    /// Gives the classes of n x n coarse cells their sizes; what they hold is left to the caller.
    pub fn resize(&mut self, n: usize) {
        self.c.resize(n * n, 0);
        self.h.resize(n * (n + 1), 0);
        self.v.resize(n * (n + 1), 0);
    }

    /// The even samples' and the others' part of fine row `j`.
    fn row_mut<'a>(&'a mut self, even: &'a mut [i32], n: usize, j: usize) -> (&'a mut [i32], &'a mut [i32]) {
        let (k, w) = (j / 2, n + 1);
        let (whole, half) =
            if j.is_multiple_of(2) { (even, &mut self.h[..]) } else { (&mut self.v[..], &mut self.c[..]) };
        (&mut whole[k * w..][..w], &mut half[k * n..][..n])
    }
}

/// Splits a fine square of side 2n+1 into its even nodes and its three new classes.
#[must_use]
pub fn split(fine: &[i32], n: usize) -> (Vec<i32>, Classes) {
    let mut even = vec![0; (n + 1) * (n + 1)];
    let mut new = Classes::default();
    new.resize(n);
    for (j, row) in fine.chunks_exact(2 * n + 1).enumerate() {
        split_row(row, j, n, &mut even, &mut new);
    }
    (even, new)
}

/// Row `j` of [`split`]: what it holds of the even nodes and of the classes.
#[inline(always)]
pub fn split_row(row: &[i32], j: usize, n: usize, even: &mut [i32], new: &mut Classes) {
    let (whole, half) = new.row_mut(even, n, j);
    for ((pair, w), h) in row.as_chunks::<2>().0.iter().zip(&mut *whole).zip(half) {
        [*w, *h] = *pair;
    }
    whole[n] = row[2 * n];
}

/// Inverse of [`split`].
#[must_use]
#[multiversion(targets = "simd")]
pub fn join(even: &[i32], new: &Classes, n: usize) -> Vec<i32> {
    let side = 2 * n + 1;
    let mut fine = Vec::with_capacity(side * side);
    let mut pairs = vec![[0; 2]; n];
    for j in 0..side {
        let k = j / 2;
        let (whole, half) = if j % 2 == 0 { (even, &new.h) } else { (&new.v[..], &new.c) };
        let (whole, half) = (&whole[k * (n + 1)..][..n + 1], &half[k * n..][..n]);
        for ((pair, w), h) in pairs.iter_mut().zip(whole).zip(half) {
            *pair = [*w, *h];
        }
        fine.extend_from_slice(pairs.as_flattened());
        fine.push(whole[n]);
    }
    fine
}

#[inline(always)]
fn stencil(near: i32, ring: i32) -> i32 {
    (10 * near - ring + 16) >> 5
}

#[inline(always)]
fn mean4(near: i32) -> i32 {
    (near + 2) >> 2
}

/// Along a row of n+1 nodes: the midpoint after node i from the edge's own nodes.
fn along(row: &[i32], stride: usize, n: usize, i: usize) -> i32 {
    let at = |k: usize| row[k * stride];
    if i >= 1 && i + 2 <= n {
        (9 * (at(i) + at(i + 1)) - at(i - 1) - at(i + 2) + 8) >> 4
    } else {
        (at(i) + at(i + 1) + 1) >> 1
    }
}

/// Predictions of C and the activity |second differences| that its residuals are coded under.
#[multiversion(targets = "simd")]
pub fn predict_c(e: &[i32], n: usize, prediction: &mut [i32], activity: &mut [i32]) {
    let w = n + 1;
    for j in 0..n {
        let (p, a) = (&mut prediction[j * n..][..n], &mut activity[j * n..][..n]);
        let (e0, e1) = (&e[j * w..][..w], &e[(j + 1) * w..][..w]);
        let fits = n > 2 && j > 0 && j + 1 < n;
        // Without a ring: the cells at both ends of the row, or the whole of it.
        for i in (0..n).step_by(if fits { n - 1 } else { 1 }) {
            p[i] = mean4(e0[i] + e0[i + 1] + e1[i] + e1[i + 1]);
            a[i] = (e0[i] + e1[i + 1] - e0[i + 1] - e1[i]).abs();
        }
        if !fits {
            continue;
        }
        let m = n - 2;
        let (south, north) = (&e[(j - 1) * w + 1..][..m + 1], &e[(j + 2) * w + 1..][..m + 1]);
        let (l0, l1) = (&e0[..m], &e1[..m]);
        let (a0, a1) = (&e0[1..][..m + 1], &e1[1..][..m + 1]);
        let (r0, r1) = (&e0[3..][..m], &e1[3..][..m]);
        let (p, a) = (&mut p[1..][..m], &mut a[1..][..m]);
        for i in 0..m {
            let near = a0[i] + a0[i + 1] + a1[i] + a1[i + 1];
            let ring = south[i] + south[i + 1] + north[i] + north[i + 1] + l0[i] + l1[i] + r0[i] + r1[i];
            p[i] = stencil(near, ring);
            a[i] = (a0[i] + a1[i + 1] - a0[i + 1] - a1[i]).abs() + ((2 * near - ring).abs() >> 1);
        }
    }
}

/// Predictions of H and their activity, from E, C and C's residuals.
#[multiversion(targets = "simd")]
pub fn predict_h(e: &[i32], c: &[i32], rc: &[i32], n: usize, prediction: &mut [i32], activity: &mut [i32]) {
    let w = n + 1;
    for j in [0, n] {
        let inner = if j == 0 { 0 } else { n - 1 };
        for i in 0..n {
            prediction[j * n + i] = along(&e[j * w..][..w], 1, n, i);
            activity[j * n + i] = 8 * rc[inner * n + i].abs();
        }
    }
    for j in 1..n {
        let (p, a) = (&mut prediction[j * n..][..n], &mut activity[j * n..][..n]);
        let row = &e[j * w..][..w];
        let (cs, cn) = (&c[(j - 1) * n..][..n], &c[j * n..][..n]);
        let (rs, rn) = (&rc[(j - 1) * n..][..n], &rc[j * n..][..n]);
        for i in (0..n).step_by(if n > 2 { n - 1 } else { 1 }) {
            p[i] = mean4(row[i] + row[i + 1] + cs[i] + cn[i]);
            a[i] = 4 * (rs[i].abs() + rn[i].abs());
        }
        if n < 3 {
            continue;
        }
        let m = n - 2;
        let (south, north) = (&e[(j - 1) * w + 1..][..m + 1], &e[(j + 1) * w + 1..][..m + 1]);
        let here = &row[1..][..m + 1];
        let (cs0, cs1, cs2) = (&cs[..m], &cs[1..][..m], &cs[2..][..m]);
        let (cn0, cn1, cn2) = (&cn[..m], &cn[1..][..m], &cn[2..][..m]);
        let (rs0, rs1, rs2) = (&rs[..m], &rs[1..][..m], &rs[2..][..m]);
        let (rn0, rn1, rn2) = (&rn[..m], &rn[1..][..m], &rn[2..][..m]);
        let (p, a) = (&mut p[1..][..m], &mut a[1..][..m]);
        for i in 0..m {
            let near = here[i] + here[i + 1] + cs1[i] + cn1[i];
            let ring = cs0[i] + cs2[i] + cn0[i] + cn2[i] + south[i] + south[i + 1] + north[i] + north[i + 1];
            p[i] = stencil(near, ring);
            let sides = rs0[i].abs() + rs2[i].abs() + rn0[i].abs() + rn2[i].abs();
            a[i] = 4 * (rs1[i].abs() + rn1[i].abs()) + sides;
        }
    }
}

/// Predictions of V and their activity, from E, C and the residuals of C and H.
#[multiversion(targets = "simd")]
pub fn predict_v(e: &[i32], c: &[i32], rc: &[i32], rh: &[i32], n: usize, prediction: &mut [i32], activity: &mut [i32]) {
    let w = n + 1;
    for j in 0..n {
        let (p, a) = (&mut prediction[j * w..][..w], &mut activity[j * w..][..w]);
        let (e0, e1) = (&e[j * w..][..w], &e[(j + 1) * w..][..w]);
        let (cr, rr) = (&c[j * n..][..n], &rc[j * n..][..n]);
        let (hs, hn) = (&rh[j * n..][..n], &rh[(j + 1) * n..][..n]);
        for (i, inner) in [(0, 0), (n, n - 1)] {
            p[i] = along(&e[i..], w, n, j);
            a[i] = 8 * rr[inner].abs() + 4 * (hs[inner].abs() + hn[inner].abs());
        }
        if n < 2 {
            continue;
        }
        let m = n - 1;
        let (e0m, e1m) = (&e0[1..][..m], &e1[1..][..m]);
        let (cw, ce) = (&cr[..m], &cr[1..][..m]);
        let (rw, re) = (&rr[..m], &rr[1..][..m]);
        let (hs0, hs1, hn0, hn1) = (&hs[..m], &hs[1..][..m], &hn[..m], &hn[1..][..m]);
        let (p, a) = (&mut p[1..][..m], &mut a[1..][..m]);
        for i in 0..m {
            a[i] = 4 * (rw[i].abs() + re[i].abs()) + 2 * (hs0[i].abs() + hs1[i].abs() + hn0[i].abs() + hn1[i].abs());
        }
        if j == 0 || j + 1 == n {
            for i in 0..m {
                p[i] = mean4(e0m[i] + e1m[i] + cw[i] + ce[i]);
            }
            continue;
        }
        let (south, north) = (&c[(j - 1) * n..][..n], &c[(j + 1) * n..][..n]);
        let (sw, se, nw, ne) = (&south[..m], &south[1..][..m], &north[..m], &north[1..][..m]);
        let (w0, w1) = (&e0[..m], &e1[..m]);
        let (x0, x1) = (&e0[2..][..m], &e1[2..][..m]);
        for i in 0..m {
            let near = e0m[i] + e1m[i] + cw[i] + ce[i];
            let ring = sw[i] + se[i] + nw[i] + ne[i] + w0[i] + w1[i] + x0[i] + x1[i];
            p[i] = stencil(near, ring);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn split_and_join_are_inverse(n in 1usize..20, seed: u32) {
            let side = 2 * n + 1;
            let fine: Vec<i32> = (0..side * side).map(|k| (k as u32).wrapping_mul(seed | 1) as i32 >> 8).collect();
            let (even, new) = split(&fine, n);
            prop_assert_eq!(join(&even, &new, n), fine);
        }
    }

    /// On a plane a h + b the stencils reproduce every new node wherever the ring fits.
    #[test]
    fn planes_are_predicted_exactly() {
        let n = 8;
        let fine: Vec<i32> = (0..17 * 17).map(|k| 64 * (k % 17) - 96 * (k / 17) + 5).collect();
        let (e, new) = split(&fine, n);
        let (mut p, mut a) = (vec![0; n * n], vec![0; n * n]);
        predict_c(&e, n, &mut p, &mut a);
        assert_eq!(p, new.c);
        assert!(a.iter().all(|&a| a == 0));
        let zero = vec![0; n * n];
        let (mut p, mut a) = (vec![0; n * (n + 1)], vec![0; n * (n + 1)]);
        predict_h(&e, &new.c, &zero, n, &mut p, &mut a);
        assert_eq!(p, new.h);
        predict_v(&e, &new.c, &zero, &vec![0; n * (n + 1)], n, &mut p, &mut a);
        assert_eq!(p, new.v);
    }

    /// The two tiles that share an edge predict its nodes alike, whatever lies inside them.
    #[test]
    fn edges_are_predicted_along_themselves() {
        let n = 4;
        let west: Vec<i32> = (0..81).map(|k| (k * k) % 97).collect();
        let east: Vec<i32> = (0..81).map(|k| if k % 9 == 0 { west[k + 8] } else { -1000 * k as i32 }).collect();
        let v_of = |fine: &[i32]| {
            let (e, new) = split(fine, n);
            let mut p = vec![0; n * (n + 1)];
            predict_v(&e, &new.c, &vec![0; n * n], &vec![0; n * (n + 1)], n, &mut p, &mut vec![0; n * (n + 1)]);
            p
        };
        let (pw, pe) = (v_of(&west), v_of(&east));
        for j in 0..n {
            assert_eq!(pw[j * (n + 1) + n], pe[j * (n + 1)]);
        }
    }
}
