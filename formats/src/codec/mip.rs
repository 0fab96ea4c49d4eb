//! The plane `mip`: filtered means, coded as residuals to a smoothing of the tile's own nodes.
//!
//! The smoothing is node + (13 e + d - 2 f) / 128 with e, d, f the sums of differences to the
//! four side, four diagonal and four distance-2 neighbours (least squares over Earth and Moon
//! heights); outside the tile the nearest sample of the tile stands in.

use multiversion::multiversion;

use super::CodecError;
use super::constraint::{self, Means};
use super::lifting::{Classes, join, split, split_row};
use super::nodes::{HALF, add, check_range, subtract};
use super::residual::{PlaneReader, PlaneWriter};
use super::scratch::{self, Scratch};
use crate::tile::TILE_NODES;

/// Encodes a tile's means (257 x 257) given its nodes and, below the root, the parent's means at
/// the tile's even nodes (129 x 129).
#[must_use]
pub fn encode(mip: &[i32], nodes: &[i32], mean: Option<&[i32]>) -> Vec<u8> {
    let n = HALF;
    let mut predicted = Scratch::default();
    predict(nodes, &mut predicted);
    let Scratch { samples: pn, residuals: an, even: [pe, ae] } = predicted;
    let (even, new) = split(mip, n);
    let mut writer = PlaneWriter::default();
    let mut r = vec![0; (n + 1) * (n + 1)];
    subtract(&even, &pe, &mut r);
    writer.class(&r, &ae, n + 1);
    for (samples, p, a) in [(&new.c, &pn.c, &an.c), (&new.h, &pn.h, &an.h)] {
        subtract(samples, p, &mut r);
        writer.class(&r[..samples.len()], a, n);
    }
    let r = &mut r[..n * (n + 1)];
    match mean {
        Some(mean) => constraint::residuals(Means { even: &even, mean }, &new, n, &pn.v, r),
        None => subtract(&new.v, &pn.v, r),
    }
    writer.class(r, &an.v, n + 1);
    writer.finish()
}

/// Decodes what [`encode`] wrote.
pub fn decode(plane: &[u8], nodes: &[i32], mean: Option<&[i32]>) -> Result<Vec<i32>, CodecError> {
    let n = HALF;
    let mut reader = PlaneReader::new(plane)?;
    scratch::with(|scratch| {
        predict(nodes, scratch);
        let [even, re] = &mut scratch.even;
        let Classes { c, h, v } = &mut scratch.samples;
        let Classes { c: rc, h: rh, v: rv } = &mut scratch.residuals;
        reader.class(re, n + 1)?;
        add(even, re)?;
        reader.class(rc, n)?;
        add(c, rc)?;
        reader.class(rh, n)?;
        add(h, rh)?;
        reader.class(rv, n + 1)?;
        match mean {
            Some(mean) => {
                constraint::reconstruct(Means { even, mean }, c, h, n, v, rv);
                check_range(v)?;
            }
            None => add(v, rv)?,
        }
        reader.finish()?;
        Ok(join(even, &scratch.samples, n))
    })
}

/// Predictions and activities of the even samples and of the three other classes.
fn predict(nodes: &[i32], scratch: &mut Scratch) {
    scratch.samples.resize(HALF);
    scratch.residuals.resize(HALF);
    for even in &mut scratch.even {
        even.resize((HALF + 1) * (HALF + 1), 0);
    }
    smooth(nodes, scratch);
}

#[multiversion(targets = "simd")]
fn smooth(nodes: &[i32], scratch: &mut Scratch) {
    const W: usize = TILE_NODES;
    let Scratch { samples, residuals, even: [even, re] } = scratch;
    let (mut p, mut a) = ([0; W], [0; W]);
    // Row y, its ends repeated, is in slot y mod 5 while a row near it needs it.
    let mut pad = [[0i32; W + 4]; 5];
    for (y, row) in nodes.as_chunks::<W>().0.iter().enumerate().take(2) {
        repeat_ends(row, &mut pad[y]);
    }
    for j in 0..W {
        if let Some(row) = nodes.as_chunks::<W>().0.get(j + 2) {
            repeat_ends(row, &mut pad[(j + 2) % 5]);
        }
        let near = [j.saturating_sub(2), j.saturating_sub(1), j, (j + 1).min(W - 1), (j + 2).min(W - 1)];
        let [ss, s, o, n, nn] = near.map(|y| &pad[y % 5]);
        for i in 0..W {
            let x = i + 2;
            let c = o[x];
            let e = o[x - 1] + o[x + 1] + s[x] + n[x] - 4 * c;
            let d = s[x - 1] + s[x + 1] + n[x - 1] + n[x + 1] - 4 * c;
            let f = o[x - 2] + o[x + 2] + ss[x] + nn[x] - 4 * c;
            p[i] = c + ((13 * e + d - 2 * f + 64) >> 7);
            a[i] = e.abs() + (d.abs() >> 1);
        }
        split_row(&p, j, HALF, even, samples);
        split_row(&a, j, HALF, re, residuals);
    }
}

fn repeat_ends(row: &[i32; TILE_NODES], padded: &mut [i32; TILE_NODES + 4]) {
    padded[2..TILE_NODES + 2].copy_from_slice(row);
    padded[..2].fill(row[0]);
    padded[TILE_NODES + 2..].fill(row[TILE_NODES - 1]);
}

#[cfg(test)]
mod tests {
    use super::super::nodes::tests::terrain;
    use super::*;
    use proptest::prelude::*;

    /// The level above's means at a tile's inner even nodes, 0 elsewhere.
    fn means_of(samples: &[i32]) -> Vec<i32> {
        let w = HALF + 1;
        let mut mean = vec![0; w * w];
        for j in 1..HALF {
            for i in 1..HALF {
                let weighted = (0..9).map(|k| {
                    let (x, y) = (k % 3, k / 3);
                    let weight = (2 - (x as i32 - 1).abs()) * (2 - (y as i32 - 1).abs());
                    weight * samples[(2 * j + y - 1) * TILE_NODES + 2 * i + x - 1]
                });
                mean[j * w + i] = (weighted.sum::<i32>() + 8) >> 4;
            }
        }
        mean
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn round_trip(kind: u8, seed: u32, constrained: bool) {
            let nodes = terrain(kind, seed, TILE_NODES);
            let mip = terrain(kind.wrapping_add(1), seed, TILE_NODES);
            let mean = means_of(&mip);
            let mean = constrained.then_some(mean.as_slice());
            prop_assert_eq!(decode(&encode(&mip, &nodes, mean), &nodes, mean).unwrap(), mip);
        }
    }

    /// True means make the constrained samples cheaper than free ones.
    #[test]
    fn means_save_bytes() {
        let nodes = terrain(2, 7, TILE_NODES);
        let mean = means_of(&nodes);
        let free = super::super::nodes::encode(&nodes, None);
        let bound = super::super::nodes::encode(&nodes, Some(&mean));
        assert!(bound.len() * 100 < free.len() * 85, "{} against {}", bound.len(), free.len());
        let (even, _) = split(&nodes, HALF);
        assert_eq!(super::super::nodes::decode(&bound, &even, Some(&mean)).unwrap(), nodes);
    }
}
