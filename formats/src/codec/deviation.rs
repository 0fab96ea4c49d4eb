//! The plane `deviation`: codes of a tile's new nodes, from what the tile's own nodes say.
//!
//! Codes are stored as differences to the local codes, in groups of like context, each a zstd
//! frame. Centres are grouped by how much rougher than the centre its neighbours look. A side is
//! never above the centres of the two cells that share it (saturation), so sides are grouped by
//! the room between the local code and the lower of these centres, the lid. At level 0 the local
//! codes are right but in the two outermost rows and columns.

use super::CodecError;
use super::crown::Crown;
use super::nodes::HALF;
use crate::derive::local_deviation;
use crate::tile::TILE_NODES;

const NODES: usize = TILE_NODES * TILE_NODES;

/// Encodes the codes of a tile (257 x 257); nodes with both indices even have one only at the root
/// level.
#[must_use]
pub fn encode(codes: &[u8], nodes: &[i32], root: bool) -> Vec<u8> {
    let local = local(nodes);
    let mut predicted = local.clone();
    let crown = root.then(|| Crown::of(nodes)).map(|crown| (crown.predict(&mut predicted), crown));
    if predicted == codes {
        return Vec::new();
    }
    let differences =
        |places: &[usize]| -> Vec<u8> { places.iter().map(|&k| codes[k].wrapping_sub(local[k])).collect() };
    let (centres, sides) = places();
    let mut plane = Vec::new();
    write_groups(&mut plane, &differences(&centres), &centre_groups(&local));
    write_groups(&mut plane, &differences(&sides), &side_groups(codes, &local, &sides));
    if let Some((activity, crown)) = crown {
        plane.extend(crown.encode(codes, &activity));
    }
    plane
}

/// Decodes what [`encode`] wrote.
pub fn decode(plane: &[u8], nodes: &[i32], root: bool) -> Result<Vec<u8>, CodecError> {
    let local = local(nodes);
    let mut predicted = local.clone();
    let crown = root.then(|| Crown::of(nodes)).map(|crown| (crown.predict(&mut predicted), crown));
    if plane.is_empty() {
        return Ok(predicted);
    }
    let mut codes = local.clone();
    let (centres, sides) = places();
    let mut rest = plane;
    for (&k, d) in centres.iter().zip(read_groups(&mut rest, &centre_groups(&local))?) {
        codes[k] = codes[k].wrapping_add(d);
    }
    for (&k, d) in sides.iter().zip(read_groups(&mut rest, &side_groups(&codes, &local, &sides))?) {
        codes[k] = codes[k].wrapping_add(d);
    }
    match crown {
        Some((activity, crown)) => crown.decode(rest, &mut codes, &activity)?,
        None if rest.is_empty() => {}
        None => return Err(CodecError::Trailing),
    }
    Ok(codes)
}

/// Groups of a class.
const GROUPS: usize = 8;

/// Writes the values group by group: eight lengths (24 bits), eight frames; a group of zeros is
/// empty.
fn write_groups(plane: &mut Vec<u8>, values: &[u8], groups: &[u8]) {
    let mut frames: [Vec<u8>; GROUPS] = Default::default();
    for (value, &group) in values.iter().zip(groups) {
        frames[group as usize].push(*value);
    }
    for frame in &mut frames {
        // Compressing into memory cannot fail.
        *frame =
            if frame.iter().all(|&v| v == 0) { Vec::new() } else { zstd::bulk::compress(frame, 3).unwrap_or_default() };
        plane.extend_from_slice(&(frame.len() as u32).to_le_bytes()[..3]);
    }
    frames.iter().for_each(|frame| plane.extend_from_slice(frame));
}

/// Reads what [`write_groups`] wrote.
fn read_groups(plane: &mut &[u8], groups: &[u8]) -> Result<Vec<u8>, CodecError> {
    let (lengths, mut rest) = plane.split_at_checked(3 * GROUPS).ok_or(CodecError::Truncated)?;
    let mut counts = [0; GROUPS];
    groups.iter().for_each(|&g| counts[g as usize] += 1);
    let mut values: [Vec<u8>; GROUPS] = Default::default();
    for (group, length) in lengths.chunks_exact(3).enumerate() {
        let length = u32::from_le_bytes([length[0], length[1], length[2], 0]) as usize;
        let (frame, after) = rest.split_at_checked(length).ok_or(CodecError::Truncated)?;
        rest = after;
        values[group] = match length {
            0 => vec![0; counts[group]],
            _ => zstd::bulk::decompress(frame, counts[group]).map_err(|_| CodecError::Frame)?,
        };
        if values[group].len() != counts[group] {
            return Err(CodecError::Truncated);
        }
    }
    *plane = rest;
    let mut next = values.each_ref().map(|v| v.iter());
    Ok(groups.iter().map(|&g| next[g as usize].next().copied().unwrap_or(0)).collect())
}

/// The places of centres, then of horizontal and vertical sides, each row by row.
fn places() -> (Vec<usize>, Vec<usize>) {
    let of = |x0: usize, y0: usize| {
        (y0..TILE_NODES).step_by(2).flat_map(move |y| (x0..TILE_NODES).step_by(2).map(move |x| y * TILE_NODES + x))
    };
    (of(1, 1).collect(), of(1, 0).chain(of(0, 1)).collect())
}

/// The group of each centre: by the sum of the local codes of the 3 x 3 centres around it (held
/// at the tile's edge) less nine times its own.
fn centre_groups(local: &[u8]) -> Vec<u8> {
    let at = |i: usize, j: usize| i32::from(local[(2 * j + 1) * TILE_NODES + 2 * i + 1]);
    let near = |i: usize| [i.saturating_sub(1), i, (i + 1).min(HALF - 1)];
    (0..HALF * HALF)
        .map(|k| {
            let (i, j) = (k % HALF, k / HALF);
            let sum: i32 = near(j).iter().map(|&y| near(i).iter().map(|&x| at(x, y)).sum::<i32>()).sum();
            group(sum - 9 * at(i, j), [-18, -6, 0, 6, 18, 36, 72])
        })
        .collect()
}

/// The group of each side: by the room between its local code and its lid.
fn side_groups(codes: &[u8], local: &[u8], sides: &[usize]) -> Vec<u8> {
    let room = |&k: &usize| {
        let (step, place) = if (k / TILE_NODES) % 2 == 1 { (1, k % TILE_NODES) } else { (TILE_NODES, k / TILE_NODES) };
        let before = if place > 0 { codes[k - step] } else { u8::MAX };
        let after = if place < TILE_NODES - 1 { codes[k + step] } else { u8::MAX };
        i32::from(before.min(after).saturating_sub(local[k]))
    };
    sides.iter().map(|k| group(room(k), [1, 2, 3, 5, 7, 10, 15])).collect()
}

/// How many of the bounds a value has reached.
fn group(value: i32, bounds: [i32; GROUPS - 1]) -> u8 {
    bounds.iter().map(|&bound| u8::from(value >= bound)).sum()
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
            let (centres, sides) = places();
            for k in centres.into_iter().chain(sides) {
                codes[k] = codes[k].wrapping_add((k as u8) & noise);
            }
            prop_assert_eq!(&decode(&encode(&codes, &nodes, false), &nodes, false).unwrap(), &codes);
            for (k, code) in codes.iter_mut().enumerate() {
                if ((k % TILE_NODES) | (k / TILE_NODES)) & 1 == 0 && !(k % 256 == 0 && (k / TILE_NODES).is_multiple_of(256)) {
                    *code = (k as u8) & noise;
                }
            }
            prop_assert_eq!(decode(&encode(&codes, &nodes, true), &nodes, true).unwrap(), codes);
        }
    }

    #[test]
    fn damage_is_refused() {
        let nodes = vec![0; NODES];
        assert_eq!(decode(&[9, 9, 9], &nodes, false), Err(CodecError::Truncated));
        let mut codes = vec![0; NODES];
        codes[TILE_NODES + 1] = 7;
        let plane = encode(&codes, &nodes, false);
        assert_eq!(decode(&plane, &nodes, false).unwrap(), codes);
        assert_eq!(decode(&[&plane[..], &[0]].concat(), &nodes, false), Err(CodecError::Trailing));
        assert!(decode(&plane[..plane.len() - 1], &nodes, false).is_err());
        let mut frame = plane;
        frame[3 * GROUPS] ^= 0xff;
        assert_eq!(decode(&frame, &nodes, false), Err(CodecError::Frame));
    }
}
