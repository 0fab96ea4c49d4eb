//! What inspect counts, and its JSON.

use relief_formats::body::Body;
use relief_formats::codec::filled::PACKED_BYTES;
use relief_formats::file::{FormatError, Plane, Relief};
use serde_json::{Map, Value, json};

/// Counts over the index.
pub struct Facts {
    /// Encoded bytes and raw bytes of each plane, in file order.
    pub planes: [[u64; 2]; 5],
    /// Tiles of each level, the finest first.
    pub tiles: Vec<u64>,
    /// Encoded bytes of each level, the finest first.
    pub level_bytes: Vec<u64>,
}

/// Nodes that belong to one tile alone.
const OWN_NODES: u64 = 256 * 256;

impl Facts {
    pub fn of(relief: &Relief) -> Result<Self, FormatError> {
        let levels = relief.grid().root_level() as usize + 1;
        let mut facts = Self { planes: [[0; 2]; 5], tiles: vec![0; levels], level_bytes: vec![0; levels] };
        for entry in relief.entries() {
            let entry = entry?;
            let level = entry.key.level as usize;
            facts.tiles[level] += 1;
            facts.level_bytes[level] += entry.bytes();
            for (plane, length) in facts.planes.iter_mut().zip(entry.lengths) {
                plane[0] += u64::from(length);
            }
        }
        let all: u64 = facts.tiles.iter().sum();
        let sample = sample_bytes(relief.header().min_q, relief.header().max_q);
        let raw = [
            all * OWN_NODES * sample,
            (all - facts.tiles[0]) * OWN_NODES * sample,
            all * OWN_NODES / 4 * 2 * sample,
            all * OWN_NODES * 3 / 4,
            all * PACKED_BYTES as u64,
        ];
        for (plane, raw) in facts.planes.iter_mut().zip(raw) {
            plane[1] = raw;
        }
        Ok(facts)
    }
}

/// Bytes of the smallest of 8, 16 and 32 bit integers that holds both.
fn sample_bytes(min_q: i32, max_q: i32) -> u64 {
    let fits = |low: i32, high: i32| min_q >= low && max_q <= high;
    if fits(i8::MIN.into(), i8::MAX.into()) {
        1
    } else if fits(i16::MIN.into(), i16::MAX.into()) {
        2
    } else {
        4
    }
}

/// The object that `--json` prints.
pub fn json(relief: &Relief, facts: &Facts) -> Value {
    let (header, grid) = (relief.header(), relief.grid());
    let metres = |q: i32| f64::from(q) * header.step_m();
    let body = match &header.body {
        Body::Ellipsoid { name, a_m, b_m } => json!({ "name": name, "a_m": a_m, "b_m": b_m }),
        Body::Plane { crs_wkt, x0, y0, dx, dy } => {
            json!({ "name": "plane", "crs": crs_wkt, "x0": x0, "y0": y0, "dx": dx, "dy": dy })
        }
    };
    let planes: Map<String, Value> = Plane::ALL
        .iter()
        .zip(facts.planes)
        .map(|(plane, [bytes, raw])| (plane.name().into(), json!({ "bytes": bytes, "raw_bytes": raw })))
        .collect();
    json!({
        "m": header.m,
        "width": grid.width(0),
        "height": grid.height(0),
        "step_m": header.step_m(),
        "bound_m": relief.metadata().bound_m,
        "body": body,
        "vertical": relief.metadata().vertical,
        "levels": grid.root_level() + 1,
        "tiles": header.tile_count,
        "min_m": metres(header.min_q),
        "max_m": metres(header.max_q),
        "south_pole_m": metres(header.south_pole_q),
        "north_pole_m": metres(header.north_pole_q),
        "planes": planes,
        "file_bytes": header.file_bytes,
        "content_id": hex(&header.content_id),
        "sources": relief.metadata().sources,
    })
}

pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_take_the_smallest_integer() {
        assert_eq!(sample_bytes(-128, 127), 1);
        assert_eq!(sample_bytes(-129, 0), 2);
        assert_eq!(sample_bytes(0, 32_768), 4);
    }
}
