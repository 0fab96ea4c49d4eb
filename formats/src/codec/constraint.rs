//! What the coarser level's filtered means say about a level's samples.
//!
//! The mip plane of the level above holds floor((sum of [1 2 1] x [1 2 1] + 8) / 16) around every
//! even sample. When all of the nine but the one to the north are known, the mean leaves that one
//! eight values to choose from: what the mip plane costs is saved again here.

use multiversion::multiversion;

use super::lifting::Classes;
use super::nodes::SAMPLE_LIMIT;
use super::token::{unzigzag, zigzag};

/// The even samples of a square and the means known around them, (n+1)^2 each.
#[derive(Clone, Copy)]
pub struct Means<'a> {
    /// The even samples themselves.
    pub even: &'a [i32],
    /// The mip plane of the level above at the same places.
    pub mean: &'a [i32],
}

/// The eight values that are left for a sample whose southern counterpart is `south`.
#[inline(always)]
const fn interval(partial: i32, south: i32) -> (i32, i32) {
    let rest = partial - 2 * south;
    ((rest - 7) >> 1, (rest + 7) >> 1)
}

/// A sample in its interval as a rank: 0 for the value nearest to the prediction, then by turns
/// below and above it, then the rest of the longer side. Samples outside the interval contradict
/// their means, which no valid file holds; they have the even (below) and odd ranks from 8 on.
#[inline(always)]
fn rank(sample: i32, prediction: i32, (low, high): (i32, i32)) -> u32 {
    if sample < low {
        return 8 + 2 * (low - sample - 1) as u32;
    }
    if sample > high {
        return 9 + 2 * (sample - high - 1) as u32;
    }
    let near = prediction.clamp(low, high);
    let (below, above) = (near - low, high - near);
    let both = below.min(above);
    let offset = sample - near;
    if offset.abs() <= both { zigzag(-offset) } else { (offset.abs() + both) as u32 }
}

/// Inverse of [`rank`].
#[inline(always)]
fn unrank(rank: u32, prediction: i32, (low, high): (i32, i32)) -> i32 {
    let near = prediction.max(low).min(high);
    let (below, above) = (near - low, high - near);
    let both = below.min(above);
    let rank_i = rank as i32;
    let turn = unzigzag(rank).wrapping_neg();
    let beyond = rank_i.wrapping_sub(both);
    let side = if above > below { beyond } else { beyond.wrapping_neg() };
    let inside = near.wrapping_add(if rank <= 2 * both as u32 { turn } else { side });
    let far = (rank_i.wrapping_sub(8) >> 1).wrapping_add(1);
    let outside = if rank_i & 1 == 0 { low.wrapping_sub(far) } else { high.wrapping_add(far) };
    if rank < 8 { inside } else { outside }
}

/// 16 mean minus everything known around the inner even samples of rows 1..n but V's part.
#[multiversion(targets = "simd")]
fn partial_sums(means: Means<'_>, c: &[i32], h: &[i32], n: usize, out: &mut [i32]) {
    let w = n + 1;
    for j in 1..n {
        let o = &mut out[j * w + 1..][..n - 1];
        let (mean, even) = (&means.mean[j * w + 1..][..n - 1], &means.even[j * w + 1..][..n - 1]);
        let (hw, he) = (&h[j * n..][..n - 1], &h[j * n + 1..][..n - 1]);
        let (cs, cn) = (&c[(j - 1) * n..][..n], &c[j * n..][..n]);
        let (sw, se, nw, ne) = (&cs[..n - 1], &cs[1..][..n - 1], &cn[..n - 1], &cn[1..][..n - 1]);
        for i in 0..n - 1 {
            o[i] = 16 * mean[i] - 4 * even[i] - 2 * (hw[i] + he[i]) - (sw[i] + se[i] + nw[i] + ne[i]);
        }
    }
}

/// The residuals of V: ranks where the interval is known, else differences to the prediction.
pub fn residuals(means: Means<'_>, new: &Classes, n: usize, prediction: &[i32], residual: &mut [i32]) {
    let w = n + 1;
    let mut partial = vec![0; w * w];
    partial_sums(means, &new.c, &new.h, n, &mut partial);
    for ((r, v), p) in residual.iter_mut().zip(&new.v).zip(prediction) {
        *r = v - p;
    }
    for j in 1..n {
        for k in j * w + 1..j * w + n {
            let bounds = interval(partial[k], new.v[k - w]);
            residual[k] = unzigzag(rank(new.v[k], prediction[k], bounds));
        }
    }
}

/// Inverse of [`residuals`]: V's samples in place of their predictions.
#[multiversion(targets = "simd")]
pub fn reconstruct(means: Means<'_>, c: &[i32], h: &[i32], n: usize, v: &mut [i32], residual: &[i32]) {
    let w = n + 1;
    // The first row and both ends of the others: differences. A damaged plane may hold anything;
    // the caller rejects samples out of range.
    let hold = |v: i32| v.clamp(-SAMPLE_LIMIT - 1, SAMPLE_LIMIT + 1);
    for (v, r) in v.iter_mut().zip(residual).take(w) {
        *v = hold(v.wrapping_add(*r));
    }
    for j in 1..n {
        let m = n - 1;
        let (before, here) = v.split_at_mut(j * w);
        let (south, v) = (&before[(j - 1) * w + 1..][..m], &mut here[..w]);
        let r = &residual[j * w..][..w];
        for i in [0, n] {
            v[i] = hold(v[i].wrapping_add(r[i]));
        }
        let (v, r) = (&mut v[1..][..m], &r[1..][..m]);
        let (mean, even) = (&means.mean[j * w + 1..][..m], &means.even[j * w + 1..][..m]);
        let (hw, he) = (&h[j * n..][..m], &h[j * n + 1..][..m]);
        let (cs, cn) = (&c[(j - 1) * n..][..n], &c[j * n..][..n]);
        let (sw, se, nw, ne) = (&cs[..m], &cs[1..][..m], &cn[..m], &cn[1..][..m]);
        for i in 0..m {
            let partial = 16 * mean[i] - 4 * even[i] - 2 * (hw[i] + he[i]) - (sw[i] + se[i] + nw[i] + ne[i]);
            let prediction = v[i].clamp(-(1 << 28), 1 << 28);
            v[i] = hold(unrank(zigzag(r[i]), prediction, interval(partial, south[i])));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ranks_are_dense_and_invertible(prediction in -50i32..50, partial in -90i32..90, south in -9i32..9) {
            let bounds = interval(partial, south);
            prop_assert_eq!(bounds.1 - bounds.0, 7);
            let mut seen = [false; 8];
            for v in bounds.0..=bounds.1 {
                let r = rank(v, prediction, bounds);
                prop_assert_eq!(unrank(r, prediction, bounds), v);
                seen[r as usize] = true;
            }
            prop_assert!(seen.iter().all(|&s| s));
            for v in [bounds.0 - 1, bounds.0 - 9, bounds.1 + 1, bounds.1 + 1000] {
                let r = rank(v, prediction, bounds);
                prop_assert!(r >= 8);
                prop_assert_eq!(unrank(r, prediction, bounds), v);
            }
            prop_assert_eq!(rank(prediction.clamp(bounds.0, bounds.1), prediction, bounds), 0);
        }
    }
}
