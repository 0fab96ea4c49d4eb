//! What the coarser level's filtered means say about a level's samples.
//!
//! The mip plane of the level above holds floor((sum of [1 2 1] x [1 2 1] + 8) / 16) around every
//! even sample. When all of the nine but the one to the north are known, the mean leaves that one
//! eight values to choose from: what the mip plane costs is saved again here.

use multiversion::multiversion;

use super::lifting::Classes;

/// The even samples of a square and the means known around them, (n+1)^2 each.
#[derive(Clone, Copy)]
pub struct Means<'a> {
    /// The even samples themselves.
    pub even: &'a [i32],
    /// The mip plane of the level above at the same places.
    pub mean: &'a [i32],
}

/// Replaces row `j` >= 1 of `prediction` (of class V) by the value in the allowed interval that
/// is nearest to it, from the sums that [`partial_sums`] left and V's row j - 1.
#[inline]
fn clamp_row(partial: &[i32], south: &[i32], prediction: &mut [i32]) {
    for ((p, &v), &s) in prediction.iter_mut().zip(south).zip(partial) {
        let rest = s - 2 * v;
        *p = (*p).clamp((rest - 7) >> 1, (rest + 7) >> 1);
    }
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

/// Turns predictions of V into residuals: `residual` = V - clamped prediction.
pub fn residuals(means: Means<'_>, new: &Classes, n: usize, prediction: &mut [i32], residual: &mut [i32]) {
    let w = n + 1;
    let mut partial = vec![0; w * w];
    partial_sums(means, &new.c, &new.h, n, &mut partial);
    for j in 1..n {
        let inner = j * w + 1..j * w + n;
        clamp_row(&partial[inner.clone()], &new.v[inner.start - w..inner.end - w], &mut prediction[inner]);
    }
    for ((r, v), p) in residual.iter_mut().zip(&new.v).zip(prediction.iter()) {
        *r = v - p;
    }
}

/// Inverse of [`residuals`]: fills `v` from predictions and residuals, row by row.
pub fn reconstruct(means: Means<'_>, new: &mut Classes, n: usize, prediction: &mut [i32], residual: &[i32]) {
    let w = n + 1;
    let mut partial = vec![0; w * w];
    partial_sums(means, &new.c, &new.h, n, &mut partial);
    new.v.resize(w * n, 0);
    for j in 0..n {
        let row = j * w..(j + 1) * w;
        if j >= 1 {
            let inner = row.start + 1..row.end - 1;
            clamp_row(&partial[inner.clone()], &new.v[inner.start - w..inner.end - w], &mut prediction[inner]);
        }
        for ((v, p), r) in new.v[row.clone()].iter_mut().zip(&prediction[row.clone()]).zip(&residual[row]) {
            // A damaged plane may hold anything; the caller rejects samples out of range.
            *v = p.wrapping_add(*r).clamp(-super::nodes::SAMPLE_LIMIT - 1, super::nodes::SAMPLE_LIMIT + 1);
        }
    }
}
