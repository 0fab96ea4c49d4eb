//! The plane `deviation`: codes of a tile's new nodes, from what the tile's own nodes say.
//!
//! Centres come first, as differences to the local codes, under how much rougher than the centre
//! its neighbours look. A side is never above the centres of the two cells that share it
//! (saturation), so what is stored is how far it lies below the lower of them, under how far the
//! local code does. At level 0 the local codes are right but on the tile's edge.

use super::CodecError;
use super::nodes::HALF;
use super::residual::{PlaneReader, PlaneWriter};
use super::token::{unzigzag, zigzag};
use crate::derive::local_deviation;
use crate::tile::TILE_NODES;

const NODES: usize = TILE_NODES * TILE_NODES;

/// Encodes the codes of a tile (257 x 257, 0 at nodes with both indices even).
#[must_use]
pub fn encode(codes: &[u8], nodes: &[i32]) -> Vec<u8> {
    let local = local(nodes);
    if local == codes {
        return Vec::new();
    }
    let mut writer = PlaneWriter::default();
    let difference: Vec<i32> = Class::Centre.places().map(|k| residual(codes[k].wrapping_sub(local[k]))).collect();
    writer.class(&difference, &centre_activity(&local), HALF);
    for class in [Class::Horizontal, Class::Vertical] {
        let (below, activity): (Vec<i32>, Vec<i32>) = class
            .places()
            .map(|k| {
                let lid = class.lid(codes, k);
                (residual(lid.wrapping_sub(codes[k])), i32::from(lid.saturating_sub(local[k])))
            })
            .unzip();
        writer.class(&below, &activity, class.width());
    }
    writer.finish()
}

/// Decodes what [`encode`] wrote.
pub fn decode(plane: &[u8], nodes: &[i32]) -> Result<Vec<u8>, CodecError> {
    let local = local(nodes);
    if plane.is_empty() {
        return Ok(local);
    }
    let mut codes = vec![0; NODES];
    let mut reader = PlaneReader::new(plane)?;
    let mut stored = vec![0; HALF * HALF];
    reader.class(&centre_activity(&local), &mut stored, HALF)?;
    for (k, r) in Class::Centre.places().zip(&stored) {
        codes[k] = local[k].wrapping_add(code(*r)?);
    }
    for class in [Class::Horizontal, Class::Vertical] {
        let activity: Vec<i32> =
            class.places().map(|k| i32::from(class.lid(&codes, k).saturating_sub(local[k]))).collect();
        stored.resize(activity.len(), 0);
        reader.class(&activity, &mut stored, class.width())?;
        for (k, r) in class.places().zip(&stored) {
            codes[k] = class.lid(&codes, k).wrapping_sub(code(*r)?);
        }
    }
    reader.finish()?;
    Ok(codes)
}

/// The new nodes of a tile by their indices' parity.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    /// (odd, odd).
    Centre,
    /// (odd, even).
    Horizontal,
    /// (even, odd).
    Vertical,
}

impl Class {
    fn width(self) -> usize {
        if self == Self::Vertical { HALF + 1 } else { HALF }
    }

    /// Places of the class in the tile, row by row.
    fn places(self) -> impl Iterator<Item = usize> {
        let (x0, y0) = match self {
            Self::Centre => (1, 1),
            Self::Horizontal => (1, 0),
            Self::Vertical => (0, 1),
        };
        (y0..TILE_NODES).step_by(2).flat_map(move |y| (x0..TILE_NODES).step_by(2).map(move |x| y * TILE_NODES + x))
    }

    /// The lower code of the two centres beside a side; on the tile's edge there is one.
    fn lid(self, codes: &[u8], k: usize) -> u8 {
        let (step, place) = match self {
            Self::Vertical => (1, k % TILE_NODES),
            _ => (TILE_NODES, k / TILE_NODES),
        };
        let before = if place > 0 { codes[k - step] } else { u8::MAX };
        let after = if place < TILE_NODES - 1 { codes[k + step] } else { u8::MAX };
        before.min(after)
    }
}

/// A code or a difference of codes (modulo 256) as a residual: small numbers stay small.
fn residual(code: u8) -> i32 {
    unzigzag(u32::from(code))
}

fn code(residual: i32) -> Result<u8, CodecError> {
    u8::try_from(zigzag(residual)).map_err(|_| CodecError::Range)
}

/// For each centre, the sum of its eight neighbours' local codes less eight times its own, moved
/// up by 64 codes and held at 0.
fn centre_activity(local: &[u8]) -> Vec<i32> {
    let at = |i: usize, j: usize| i32::from(local[(2 * j + 1) * TILE_NODES + 2 * i + 1]);
    let near = |i: usize| [i.saturating_sub(1), i, (i + 1).min(HALF - 1)];
    (0..HALF * HALF)
        .map(|k| {
            let (i, j) = (k % HALF, k / HALF);
            let sum: i32 = near(j).iter().map(|&y| near(i).iter().map(|&x| at(x, y)).sum::<i32>()).sum();
            (sum - 9 * at(i, j) + 64).max(0)
        })
        .collect()
}

fn local(nodes: &[i32]) -> Vec<u8> {
    local_deviation(nodes, TILE_NODES).unwrap_or_else(|| vec![0; NODES])
}

#[cfg(test)]
mod tests {
    use super::super::nodes::tests::terrain;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn round_trip(kind: u8, seed: u32, noise: u8) {
            let nodes = terrain(kind, seed, TILE_NODES);
            let mut codes = local(&nodes);
            for k in [Class::Centre, Class::Horizontal, Class::Vertical].into_iter().flat_map(Class::places) {
                codes[k] = codes[k].wrapping_add((k as u8) & noise);
            }
            prop_assert_eq!(decode(&encode(&codes, &nodes), &nodes).unwrap(), codes);
        }
    }

    #[test]
    fn damage_is_refused() {
        let nodes = vec![0; NODES];
        assert_eq!(decode(&[9, 9, 9], &nodes), Err(CodecError::Truncated));
        let mut writer = PlaneWriter::default();
        writer.class(&vec![1 << 9; HALF * HALF], &centre_activity(&local(&nodes)), HALF);
        assert!(decode(&writer.finish(), &nodes).is_err());
    }
}
