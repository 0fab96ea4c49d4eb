//! The plane `nodes`: a tile's heights in steps, lossless.
//!
//! A tile below the root knows its even nodes from its parent's quarter. A root tile starts from
//! its four corners and refines itself: squares of 1, 2, 4 ... 128 coarse cells in turn.

use multiversion::multiversion;

use super::CodecError;
use super::bytes;
use super::constraint::{self, Means};
use super::lifting::{Classes, join, predict_c, predict_h, predict_v, split};
use super::residual::{PlaneReader, PlaneWriter};
use super::scratch::{self, Scratch};
use crate::tile::TILE_CELLS;

/// Largest magnitude of a sample: |q| < 2^23, so every prediction fits 32 bits and every height
/// is exact in f32.
pub const SAMPLE_LIMIT: i32 = (1 << 23) - 1;

/// Coarse cells along a tile's side.
pub const HALF: usize = TILE_CELLS as usize / 2;

/// Encodes a tile that has a parent. `fine` is 257 x 257; `mean` is the parent's mip plane at the
/// tile's even nodes (129 x 129) for level 0, none for the coarser levels.
#[must_use]
pub fn encode(fine: &[i32], mean: Option<&[i32]>) -> Vec<u8> {
    let (even, new) = split(fine, HALF);
    let mut writer = PlaneWriter::default();
    write_stage(&mut writer, &even, &new, mean, HALF);
    writer.finish()
}

/// Decodes what [`encode`] wrote, from the parent's nodes at the tile's even nodes (129 x 129).
pub fn decode(plane: &[u8], even: &[i32], mean: Option<&[i32]>) -> Result<Vec<i32>, CodecError> {
    let mut reader = PlaneReader::new(plane)?;
    scratch::with(|scratch| {
        read_stage(&mut reader, even, mean, HALF, scratch)?;
        reader.finish()?;
        Ok(join(even, &scratch.samples, HALF))
    })
}

/// Encodes a root tile: four corners as i32, then the stages.
#[must_use]
pub fn encode_root(fine: &[i32]) -> Vec<u8> {
    let side = 2 * HALF + 1;
    let mut out = Vec::new();
    for corner in [0, side - 1, (side - 1) * side, side * side - 1] {
        out.extend_from_slice(&fine[corner].to_le_bytes());
    }
    let mut writer = PlaneWriter::default();
    let mut n = 1;
    while n <= HALF {
        let stride = HALF / n;
        let square: Vec<i32> =
            fine.chunks_exact(side).step_by(stride).flat_map(|row| row.iter().step_by(stride).copied()).collect();
        let (even, new) = split(&square, n);
        write_stage(&mut writer, &even, &new, None, n);
        n *= 2;
    }
    out.extend(writer.finish());
    out
}

/// Decodes what [`encode_root`] wrote.
pub fn decode_root(plane: &[u8]) -> Result<Vec<i32>, CodecError> {
    let mut plane = plane;
    let mut square = Vec::with_capacity(4);
    for _ in 0..4 {
        square.push(bytes::take_i32(&mut plane).ok_or(CodecError::Truncated)?);
    }
    check_range(&square)?;
    let mut reader = PlaneReader::new(plane)?;
    scratch::with(|scratch| {
        let mut n = 1;
        while n <= HALF {
            read_stage(&mut reader, &square, None, n, scratch)?;
            square = join(&square, &scratch.samples, n);
            n *= 2;
        }
        Ok(())
    })?;
    reader.finish()?;
    Ok(square)
}

/// The nodes of a tile that is absent: bilinear between its parent's, rounded half up.
#[must_use]
pub fn interpolate(even: &[i32], n: usize) -> Vec<i32> {
    let (w, side) = (n + 1, 2 * n + 1);
    let mut fine = vec![0; side * side];
    for j in 0..side {
        let (a, b) = (&even[j / 2 * w..][..w], &even[j.div_ceil(2) * w..][..w]);
        for (i, out) in fine[j * side..][..side].iter_mut().enumerate() {
            let (l, r) = (i / 2, i.div_ceil(2));
            *out = match (i % 2, j % 2) {
                (0, 0) => a[l],
                (1, 0) => (a[l] + a[r] + 1) >> 1,
                (0, _) => (a[l] + b[l] + 1) >> 1,
                _ => (a[l] + a[r] + b[l] + b[r] + 2) >> 2,
            };
        }
    }
    fine
}

/// The quarter of a parent's samples (257 x 257) that are a child's even samples (129 x 129).
#[must_use]
pub fn quarter(parent: &[i32], quadrant: (usize, usize)) -> Vec<i32> {
    let side = 2 * HALF + 1;
    let (x, y) = (quadrant.0 * HALF, quadrant.1 * HALF);
    let mut even = Vec::with_capacity((HALF + 1) * (HALF + 1));
    for row in parent.chunks_exact(side).skip(y).take(HALF + 1) {
        even.extend_from_slice(&row[x..][..HALF + 1]);
    }
    even
}

fn write_stage(writer: &mut PlaneWriter, even: &[i32], new: &Classes, mean: Option<&[i32]>, n: usize) {
    let edges = n * (n + 1);
    let (mut p, mut a) = (vec![0; edges], vec![0; edges]);
    let mut rc = vec![0; n * n];
    predict_c(even, n, &mut p, &mut a);
    subtract(&new.c, &p, &mut rc);
    writer.class(&rc, &a[..n * n], n);
    let mut rh = vec![0; edges];
    predict_h(even, &new.c, &rc, n, &mut p, &mut a);
    subtract(&new.h, &p, &mut rh);
    writer.class(&rh, &a, n);
    let mut rv = vec![0; edges];
    predict_v(even, &new.c, &rc, &rh, n, &mut p, &mut a);
    match mean {
        Some(mean) => constraint::residuals(Means { even, mean }, new, n, &p, &mut rv),
        None => subtract(&new.v, &p, &mut rv),
    }
    writer.class(&rv, &a, n + 1);
}

/// Reads a stage's classes into `scratch.samples`.
fn read_stage(
    reader: &mut PlaneReader<'_>,
    even: &[i32],
    mean: Option<&[i32]>,
    n: usize,
    scratch: &mut Scratch,
) -> Result<(), CodecError> {
    scratch.samples.resize(n);
    scratch.residuals.resize(n);
    let Classes { c, h, v } = &mut scratch.samples;
    let Classes { c: rc, h: rh, v: rv } = &mut scratch.residuals;
    predict_c(even, n, c, rc);
    reader.class(rc, n)?;
    add(c, rc)?;
    predict_h(even, c, rc, n, h, rh);
    reader.class(rh, n)?;
    add(h, rh)?;
    predict_v(even, c, rc, rh, n, v, rv);
    reader.class(rv, n + 1)?;
    match mean {
        Some(mean) => {
            constraint::reconstruct(Means { even, mean }, c, h, n, v, rv);
            check_range(v)
        }
        None => add(v, rv),
    }
}

/// `out` = samples - prediction.
pub(super) fn subtract(samples: &[i32], prediction: &[i32], out: &mut [i32]) {
    for ((r, s), p) in out.iter_mut().zip(samples).zip(prediction) {
        *r = s - p;
    }
}

/// Adds residuals to their predictions; refused when a sample leaves its range.
#[multiversion(targets = "simd")]
pub(super) fn add(samples: &mut [i32], residual: &[i32]) -> Result<(), CodecError> {
    let (mut min, mut max) = (0, 0);
    for (s, r) in samples.iter_mut().zip(residual) {
        *s = s.wrapping_add(*r);
        (min, max) = (min.min(*s), max.max(*s));
    }
    if min < -SAMPLE_LIMIT || max > SAMPLE_LIMIT { Err(CodecError::Range) } else { Ok(()) }
}

/// Rejects samples outside +-[`SAMPLE_LIMIT`].
#[multiversion(targets = "simd")]
pub(super) fn check_range(samples: &[i32]) -> Result<(), CodecError> {
    let (mut min, mut max) = (0, 0);
    for &s in samples {
        (min, max) = (min.min(s), max.max(s));
    }
    if min < -SAMPLE_LIMIT || max > SAMPLE_LIMIT { Err(CodecError::Range) } else { Ok(()) }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Test terrain over any square: smooth, rough, spiky, flat or a checkerboard.
    pub fn terrain(kind: u8, seed: u32, side: usize) -> Vec<i32> {
        let hash = |x: usize, y: usize| {
            let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed;
            h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
            (h ^ (h >> 13)) as i32
        };
        (0..side * side)
            .map(|k| {
                let (x, y) = (k % side, k / side);
                match kind % 6 {
                    0 => 0,
                    1 => (1000.0 * ((x as f64 / 17.0).sin() + (y as f64 / 23.0).cos())) as i32,
                    2 => hash(x, y) >> 20,
                    3 => {
                        if hash(x, y) & 1023 == 0 {
                            9000
                        } else {
                            -11_000
                        }
                    }
                    4 => {
                        if (x + y) % 2 == 0 {
                            SAMPLE_LIMIT
                        } else {
                            -SAMPLE_LIMIT
                        }
                    }
                    _ => hash(x / 16, y / 16) >> 16,
                }
            })
            .collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn round_trip(kind: u8, seed: u32) {
            let side = 2 * HALF + 1;
            let fine = terrain(kind, seed, side);
            prop_assert_eq!(&decode_root(&encode_root(&fine)).unwrap(), &fine);
            let (even, _) = split(&fine, HALF);
            prop_assert_eq!(&decode(&encode(&fine, None), &even, None).unwrap(), &fine);
        }

        #[test]
        fn junk_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..3000)) {
            let _ = decode_root(&bytes);
            let _ = decode(&bytes, &vec![0; (HALF + 1) * (HALF + 1)], None);
        }
    }

    #[test]
    fn flat_tiles_cost_nothing() {
        let side = 2 * HALF + 1;
        assert_eq!(encode(&vec![-4000; side * side], None).len(), 0);
        assert_eq!(encode_root(&vec![-4000; side * side]).len(), 16);
    }

    #[test]
    fn interpolation_is_bilinear_and_stays_between() {
        let fine = interpolate(&[0, 4, 8, 21], 1);
        assert_eq!(fine, [0, 2, 4, 4, 8, 13, 8, 15, 21]);
    }
}
