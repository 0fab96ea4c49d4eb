//! The bytes of a finished block in the journal. They never leave this machine, so they are
//! plain: numbers little-endian, fields as window and values.

use relief_formats::derive::deviation::CellDistances;
use relief_formats::derive::extremes::Extremes;
use relief_formats::derive::interval::Interval;
use relief_formats::derive::{Base, Below, Field, Window};
use relief_formats::tile::TileKey;
use relief_formats::tile_planes::EncodedTile;

use super::handoff::Handoff;
use super::stage::{BlockKey, Finished};

/// What a record holds besides tiles.
pub struct Rest {
    /// The block's summary.
    pub handoff: Handoff,
    /// True when some node is measured.
    pub measured: bool,
}

/// Where the tiles' planes start in a record: behind the fixed part, the tile heads.
pub fn tile_bytes_at(payload: &[u8]) -> u64 {
    let count = payload.get(12..16).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    16 + u64::from(count) * TILE_HEAD
}

const TILE_HEAD: u64 = 12 + 20 + 8 + 80;

/// A block's record: key, tile count, tile heads, planes, then the rest.
pub fn encode(key: BlockKey, finished: &Finished) -> Vec<u8> {
    let mut out = Vec::new();
    for v in [key.level, key.x, key.y, finished.tiles.len() as u32] {
        out.extend(v.to_le_bytes());
    }
    for tile in &finished.tiles {
        for v in [tile.key.level, tile.key.x, tile.key.y] {
            out.extend(v.to_le_bytes());
        }
        tile.planes.iter().for_each(|p| out.extend((p.len() as u32).to_le_bytes()));
        out.extend(tile.min_q.to_le_bytes());
        out.extend(tile.max_q.to_le_bytes());
        tile.digests.iter().for_each(|d| out.extend(d));
    }
    for plane in finished.tiles.iter().flat_map(|t| &t.planes) {
        out.extend_from_slice(plane);
    }
    out.push(u8::from(finished.measured));
    let handoff = &finished.handoff;
    out.extend(handoff.base.level.to_le_bytes());
    put_ints(&mut out, &handoff.base.nodes, |&q| [q]);
    put_ints(&mut out, handoff.base.mip.as_ref().unwrap_or(&handoff.base.nodes), |&q| [q]);
    put_ints(&mut out, &handoff.filled, |&f| [i32::from(f)]);
    if let Some(below) = &handoff.base.below {
        put_ints(&mut out, &below.intervals, |i| [i.lo, i.hi, i.min, i.max]);
        put_ints(&mut out, &below.extremes, |e| [e.min, e.max]);
        put_ints(&mut out, &below.centres, |&c| [i32::from(c)]);
        for distances in &below.distances {
            put_ints(&mut out, distances, |d| [d.centre, d.sides[0], d.sides[1], d.sides[2], d.sides[3]]);
        }
    }
    out
}

/// Reads a record; none when it is not one, though its hash was right.
pub fn decode(payload: &[u8]) -> Option<(BlockKey, Finished)> {
    let mut input = payload;
    let key = BlockKey { level: take_u32(&mut input)?, x: take_u32(&mut input)?, y: take_u32(&mut input)? };
    let count = take_u32(&mut input)? as usize;
    let mut tiles = Vec::new();
    let mut lengths = Vec::new();
    for _ in 0..count {
        let tile = TileKey::new(take_u32(&mut input)?, take_u32(&mut input)?, take_u32(&mut input)?);
        let mut plane_lengths = [0; 5];
        for length in &mut plane_lengths {
            *length = take_u32(&mut input)? as usize;
        }
        let (min_q, max_q) = (take_u32(&mut input)? as i32, take_u32(&mut input)? as i32);
        let mut digests = [[0; 16]; 5];
        for digest in &mut digests {
            *digest = take(&mut input)?;
        }
        lengths.push(plane_lengths);
        tiles.push(EncodedTile { key: tile, planes: Default::default(), digests, min_q, max_q });
    }
    for (tile, lengths) in tiles.iter_mut().zip(lengths) {
        for (plane, length) in tile.planes.iter_mut().zip(lengths) {
            let (bytes, rest) = input.split_at_checked(length)?;
            *plane = bytes.to_vec();
            input = rest;
        }
    }
    let [measured] = take(&mut input)?;
    let handoff = take_handoff(&mut input)?;
    Some((key, Finished { tiles, handoff, measured: measured == 1 }))
}

fn take_handoff(input: &mut &[u8]) -> Option<Handoff> {
    let level = take_u32(input)?;
    let nodes = take_ints(input, |[q]: [i32; 1]| q)?;
    let mip = take_ints(input, |[q]: [i32; 1]| q)?;
    let filled = take_ints(input, |[f]: [i32; 1]| f != 0)?;
    let intervals = take_ints(input, |[lo, hi, min, max]: [i32; 4]| Interval { lo, hi, min, max })?;
    let extremes = take_ints(input, |[min, max]: [i32; 2]| Extremes { min, max })?;
    let centres = take_ints(input, |[c]: [i32; 1]| c as u8)?;
    let mut distances = Vec::new();
    while !input.is_empty() {
        distances
            .push(take_ints(input, |[centre, a, b, c, d]: [i32; 5]| CellDistances { centre, sides: [a, b, c, d] })?);
    }
    let below = Some(Below { intervals, extremes, centres, distances });
    Some(Handoff { base: Base { level, nodes, mip: Some(mip), below }, filled })
}

fn put_ints<T: Copy + Default, const N: usize>(out: &mut Vec<u8>, field: &Field<T>, ints: impl Fn(&T) -> [i32; N]) {
    let w = field.window();
    for v in [w.x0, w.y0, w.nx as i32, w.ny as i32] {
        out.extend(v.to_le_bytes());
    }
    out.extend(field.data().iter().flat_map(ints).flat_map(i32::to_le_bytes));
}

fn take_ints<T: Copy + Default, const N: usize>(input: &mut &[u8], value: impl Fn([i32; N]) -> T) -> Option<Field<T>> {
    let mut head = [0; 4];
    for v in &mut head {
        *v = take_u32(input)? as i32;
    }
    let window = Window::new(head[0], head[1], head[2] as usize, head[3] as usize);
    let (bytes, rest) = input.split_at_checked(window.nx.checked_mul(window.ny)?.checked_mul(4 * N)?)?;
    *input = rest;
    let data = bytes
        .chunks_exact(4 * N)
        .map(|c| {
            value(std::array::from_fn(|k| i32::from_le_bytes([c[4 * k], c[4 * k + 1], c[4 * k + 2], c[4 * k + 3]])))
        })
        .collect();
    Field::from_data(window, data)
}

fn take<const N: usize>(input: &mut &[u8]) -> Option<[u8; N]> {
    let (head, rest) = input.split_first_chunk()?;
    *input = rest;
    Some(*head)
}

fn take_u32(input: &mut &[u8]) -> Option<u32> {
    take(input).map(u32::from_le_bytes)
}
