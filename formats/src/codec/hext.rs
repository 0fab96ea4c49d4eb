//! The plane `hext`: extremes of S_0 over 2 x 2 cells of a tile, rounded outwards.
//!
//! The nine nodes of a 2 x 2 block are the exact answer at level 0 and the prediction above it.
//! What lies beyond them is stored as a code times a unit: a power of two, an eighth to a quarter
//! of the nine nodes' own range. Stored bounds never lie inside the true ones. Codes are coded as
//! two classes, first below then above, under the bits of that range.

use super::CodecError;
use super::nodes::{HALF, SAMPLE_LIMIT};
use super::residual::{PlaneReader, PlaneWriter};
use super::token::{unzigzag, zigzag};
use crate::derive::extremes::Extremes;
use crate::tile::TILE_NODES;

/// Cells of the plane.
pub const CELLS: usize = HALF * HALF;

/// The code of 2^24 units, more than any height is away.
const LAST_CODE: u8 = 104;

/// Extremes of the nine nodes of every 2 x 2 block of a tile's nodes (257 x 257).
#[must_use]
pub fn of_nodes(nodes: &[i32]) -> Vec<Extremes> {
    let mut out = Vec::with_capacity(CELLS);
    let mut low = [0; TILE_NODES];
    let mut high = [0; TILE_NODES];
    for j in 0..HALF {
        let row = |k: usize| &nodes[(2 * j + k) * TILE_NODES..][..TILE_NODES];
        let rows = row(0).iter().zip(row(1)).zip(row(2));
        for (((&a, &b), &c), (low, high)) in rows.zip(low.iter_mut().zip(&mut high)) {
            *low = a.min(b).min(c);
            *high = a.max(b).max(c);
        }
        out.extend((0..HALF).map(|i| Extremes {
            min: low[2 * i].min(low[2 * i + 1]).min(low[2 * i + 2]),
            max: high[2 * i].max(high[2 * i + 1]).max(high[2 * i + 2]),
        }));
    }
    out
}

/// log2 of the unit of a block whose nine nodes span `range` steps.
fn unit_bits(range: i32) -> u32 {
    ((range.max(0) as u32) + 1).ilog2().saturating_sub(2)
}

/// What code c stands for, in units: 0..15, then four codes an octave.
fn decode_code(code: u8) -> i64 {
    let c = i64::from(code);
    if c < 16 { c } else { (4 + (c & 3)) << ((c >> 2) - 2) }
}

/// The smallest code not below `units`.
fn encode_code(units: i64) -> u8 {
    if units < 16 {
        return units as u8;
    }
    let shift = units.ilog2() - 2;
    let code = (i64::from(shift) + 2) * 4 + ((units >> shift) & 3);
    let exact = units & ((1 << shift) - 1) == 0;
    (code + i64::from(!exact)) as u8
}

/// Encodes true extremes over the tile's blocks; also returns what a reader will see.
#[must_use]
pub fn encode(extremes: &[Extremes], nodes: &[i32]) -> (Vec<u8>, Vec<Extremes>) {
    let predicted = of_nodes(nodes);
    if predicted == extremes {
        return (Vec::new(), predicted);
    }
    let (mut lows, mut highs) = (vec![0; CELLS], vec![0; CELLS]);
    let mut stored = Vec::with_capacity(CELLS);
    for (((t, p), low), high) in extremes.iter().zip(&predicted).zip(&mut lows).zip(&mut highs) {
        let bits = unit_bits(p.max - p.min);
        let code = |excess: i32| encode_code((i64::from(excess.max(0)) + (1 << bits) - 1) >> bits);
        let (below, above) = (code(p.min - t.min), code(t.max - p.max));
        (*low, *high) = (unzigzag(u32::from(below)), unzigzag(u32::from(above)));
        stored.push(widen(*p, bits, below, above));
    }
    let activity = activity(&predicted);
    let mut writer = PlaneWriter::default();
    writer.class(&lows, &activity, HALF);
    writer.class(&highs, &activity, HALF);
    (writer.finish(), stored)
}

/// Decodes what [`encode`] wrote.
pub fn decode(plane: &[u8], nodes: &[i32]) -> Result<Vec<Extremes>, CodecError> {
    let predicted = of_nodes(nodes);
    if plane.is_empty() {
        return Ok(predicted);
    }
    let mut lows = activity(&predicted);
    let mut highs = lows.clone();
    let mut reader = PlaneReader::new(plane)?;
    reader.class(&mut lows, HALF)?;
    reader.class(&mut highs, HALF)?;
    reader.finish()?;
    let code = |r: i32| u8::try_from(zigzag(r)).ok().filter(|&c| c <= LAST_CODE).ok_or(CodecError::Range);
    let cells = predicted.iter().zip(lows).zip(highs);
    cells.map(|((p, low), high)| Ok(widen(*p, unit_bits(p.max - p.min), code(low)?, code(high)?))).collect()
}

/// The codes' activity: how many units the nine nodes span, so flats and slopes part.
fn activity(predicted: &[Extremes]) -> Vec<i32> {
    predicted.iter().map(|p| p.max - p.min).collect()
}

fn widen(p: Extremes, bits: u32, low: u8, high: u8) -> Extremes {
    let limit = i64::from(SAMPLE_LIMIT);
    Extremes {
        min: (i64::from(p.min) - (decode_code(low) << bits)).max(-limit) as i32,
        max: (i64::from(p.max) + (decode_code(high) << bits)).min(limit) as i32,
    }
}

#[cfg(test)]
mod tests {
    use super::super::nodes::tests::terrain;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn codes_round_up_and_never_below() {
        for units in (0..5000).chain([1 << 24, (1 << 24) - 1, (1 << 25) - 3]) {
            let code = encode_code(units);
            assert!(code <= LAST_CODE && decode_code(code) >= units, "{units}");
            assert!(units == 0 || decode_code(code - 1) < units, "{units}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn bounds_stay_outside_and_round_trip(kind: u8, seed: u32, spread in 0i32..1 << 22) {
            let nodes = terrain(kind, seed, TILE_NODES);
            let truth: Vec<Extremes> = of_nodes(&nodes)
                .iter()
                .enumerate()
                .map(|(k, p)| {
                    let more = (k as i32).wrapping_mul(977) & spread;
                    Extremes { min: (p.min - more).max(-SAMPLE_LIMIT), max: (p.max + more / 3).min(SAMPLE_LIMIT) }
                })
                .collect();
            let (plane, stored) = encode(&truth, &nodes);
            prop_assert!(stored.iter().zip(&truth).all(|(s, t)| s.min <= t.min && s.max >= t.max));
            prop_assert_eq!(decode(&plane, &nodes).unwrap(), stored);
        }
    }

    #[test]
    fn damage_is_refused() {
        let nodes = terrain(1, 1, TILE_NODES);
        assert_eq!(decode(&[1, 2, 3], &nodes), Err(CodecError::Truncated));
        let mut writer = PlaneWriter::default();
        let wild = vec![unzigzag(u32::from(LAST_CODE) + 1); CELLS];
        writer.class(&wild, &activity(&of_nodes(&nodes)), HALF);
        writer.class(&wild, &activity(&of_nodes(&nodes)), HALF);
        assert_eq!(decode(&writer.finish(), &nodes), Err(CodecError::Range));
    }
}
