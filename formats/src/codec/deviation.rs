//! The plane `deviation`: codes of a tile's new nodes, from what the tile's own nodes say.
//!
//! Codes are stored as differences to the local codes, in groups of like context, each a zstd
//! frame. Centres are grouped by how much rougher than the centre its neighbours look. A side is
//! never above the centres of the two cells that share it (saturation), so sides are grouped by
//! the room between the local code and the lower of these centres, the lid. At level 0 the local
//! codes are right but in the two outermost rows and columns; above it most sides are at their lid
//! or close below, so there the differences are to that.

use std::sync::LazyLock;

use super::CodecError;
use super::crown::Crown;
use super::frame::compress_symbols;
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
    write_groups(&mut plane, &differences(centres), &centre_groups(&local));
    let (groups, lids) = side_groups(codes, &local);
    let at_lid = sides.iter().zip(&lids).filter(|&(&k, &lid)| codes[k] == lid).count();
    let at_local = sides.iter().filter(|&&k| codes[k] == local[k]).count();
    if at_lid > at_local {
        plane.push(FROM_LID);
        let below: Vec<u8> = sides.iter().zip(&lids).map(|(&k, lid)| lid.wrapping_sub(codes[k])).collect();
        write_groups(&mut plane, &below, &groups);
    } else {
        plane.push(FROM_LOCAL);
        write_groups(&mut plane, &differences(sides), &groups);
    }
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
    let (groups, lids) = side_groups(&codes, &local);
    let (&from, after) = rest.split_first().ok_or(CodecError::Truncated)?;
    rest = after;
    let values = read_groups(&mut rest, &groups)?;
    match from {
        FROM_LOCAL => sides.iter().zip(values).for_each(|(&k, d)| codes[k] = codes[k].wrapping_add(d)),
        FROM_LID => sides.iter().zip(lids).zip(values).for_each(|((&k, lid), d)| codes[k] = lid.wrapping_sub(d)),
        _ => return Err(CodecError::Range),
    }
    match crown {
        Some((activity, crown)) => crown.decode(rest, &mut codes, &activity)?,
        None if rest.is_empty() => {}
        None => return Err(CodecError::Trailing),
    }
    Ok(codes)
}

/// Sides are differences to the local codes.
const FROM_LOCAL: u8 = 0;
/// Sides are what they are below their lids.
const FROM_LID: u8 = 1;
/// Groups of a class.
const GROUPS: usize = 8;

/// Writes the values group by group: eight lengths (24 bits), eight frames; a group of zeros is
/// empty.
fn write_groups(plane: &mut Vec<u8>, values: &[u8], groups: &[u8]) {
    let mut counts = [0; GROUPS];
    groups.iter().for_each(|&g| counts[usize::from(g) % GROUPS] += 1);
    let mut end = 0;
    let ranges = counts.map(|count| {
        end += count;
        end - count..end
    });
    let mut next = ranges.each_ref().map(|range| range.start);
    let mut sorted = vec![0; values.len()];
    for (value, &group) in values.iter().zip(groups) {
        let place = &mut next[usize::from(group) % GROUPS];
        sorted[*place] = *value;
        *place += 1;
    }
    let frames = ranges.map(|range| {
        let values = &sorted[range];
        if values.iter().all(|&v| v == 0) { Vec::new() } else { compress_symbols(values) }
    });
    for frame in &frames {
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
static PLACES: LazyLock<(Vec<usize>, Vec<usize>)> = LazyLock::new(|| {
    let of = |x0: usize, y0: usize| {
        (y0..TILE_NODES).step_by(2).flat_map(move |y| (x0..TILE_NODES).step_by(2).map(move |x| y * TILE_NODES + x))
    };
    (of(1, 1).collect(), of(1, 0).chain(of(0, 1)).collect())
});

fn places() -> (&'static [usize], &'static [usize]) {
    (&PLACES.0, &PLACES.1)
}

/// Most that the sum of nine codes can differ from nine times a code.
const MOST: i32 = 9 * u8::MAX as i32;
/// Groups of centres by that difference, from -MOST on.
static CENTRE_GROUP: [u8; 2 * MOST as usize + 1] = table(-MOST, [-18, -6, 0, 6, 18, 36, 72]);
/// Groups of sides by the room.
static SIDE_GROUP: [u8; 256] = table(0, [1, 2, 3, 5, 7, 10, 15]);

/// For every value from `first` on: how many of the bounds it has reached.
const fn table<const N: usize>(first: i32, bounds: [i32; GROUPS - 1]) -> [u8; N] {
    let mut groups = [0; N];
    let mut k = 0;
    while k < N {
        let mut group = 0;
        while group < GROUPS - 1 && first + k as i32 >= bounds[group] {
            group += 1;
        }
        groups[k] = group as u8;
        k += 1;
    }
    groups
}

/// The group of each centre: by the sum of the local codes of the 3 x 3 centres around it (held
/// at the tile's edge) less nine times its own.
fn centre_groups(local: &[u8]) -> Vec<u8> {
    let row = |j: usize| &local[(2 * j + 1) * TILE_NODES..][..TILE_NODES];
    let mut groups = Vec::with_capacity(HALF * HALF);
    // Sums of three rows, the outermost repeated on both sides.
    let mut sums = [0; HALF + 2];
    for j in 0..HALF {
        let (south, here, north) = (row(j.saturating_sub(1)), row(j), row((j + 1).min(HALF - 1)));
        for (i, sum) in sums[1..=HALF].iter_mut().enumerate() {
            let x = 2 * i + 1;
            *sum = i32::from(south[x]) + i32::from(here[x]) + i32::from(north[x]);
        }
        (sums[0], sums[HALF + 1]) = (sums[1], sums[HALF]);
        groups.extend((0..HALF).map(|i| {
            let more = sums[i] + sums[i + 1] + sums[i + 2] - 9 * i32::from(here[2 * i + 1]);
            CENTRE_GROUP[(more + MOST) as usize]
        }));
    }
    groups
}

/// The group of each side, by the room between its local code and its lid, and the lid.
fn side_groups(codes: &[u8], local: &[u8]) -> (Vec<u8>, Vec<u8>) {
    const LAST: usize = TILE_NODES - 1;
    const SIDES: usize = 2 * HALF * (HALF + 1);
    let (mut groups, mut lids) = (Vec::with_capacity(SIDES), Vec::with_capacity(SIDES));
    // Beyond the tile there is no lid.
    static NONE: [u8; TILE_NODES] = [u8::MAX; TILE_NODES];
    fn row(of: &[u8], y: usize) -> &[u8; TILE_NODES] {
        of.get(y * TILE_NODES..).and_then(|rest| rest.first_chunk()).unwrap_or(&NONE)
    }
    let mut put = |a: u8, b: u8, local: u8| {
        let lid = a.min(b);
        groups.push(SIDE_GROUP[usize::from(lid.saturating_sub(local))]);
        lids.push(lid);
    };
    for y in (0..TILE_NODES).step_by(2) {
        let south = if y > 0 { row(codes, y - 1) } else { &NONE };
        let (here, north) = (row(local, y), row(codes, y + 1));
        (1..LAST).step_by(2).for_each(|x| put(south[x], north[x], here[x]));
    }
    for y in (1..TILE_NODES).step_by(2) {
        let (codes, here) = (row(codes, y), row(local, y));
        put(u8::MAX, codes[1], here[0]);
        (2..LAST).step_by(2).for_each(|x| put(codes[x - 1], codes[x + 1], here[x]));
        put(codes[LAST - 1], u8::MAX, here[LAST]);
    }
    (groups, lids)
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
            for &k in centres.iter().chain(sides) {
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
