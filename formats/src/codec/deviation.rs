//! The plane `deviation`: codes of a tile's new nodes, as differences to what the tile's own
//! nodes say. At level 0 the differences are zero but on the tile's edge.

use super::CodecError;
use crate::derive::local_deviation;
use crate::tile::TILE_NODES;

const NODES: usize = TILE_NODES * TILE_NODES;

/// The places of the new nodes of a tile: not both indices even; row by row.
fn new_nodes() -> impl Iterator<Item = usize> {
    (0..NODES).filter(|k| (k / TILE_NODES) % 2 == 1 || (k % TILE_NODES) % 2 == 1)
}

/// Encodes the codes of a tile (257 x 257, 0 at nodes with both indices even).
#[must_use]
pub fn encode(codes: &[u8], nodes: &[i32]) -> Vec<u8> {
    let local = local(nodes);
    if local == codes {
        return Vec::new();
    }
    let difference: Vec<u8> = new_nodes().map(|k| codes[k].wrapping_sub(local[k])).collect();
    zstd::bulk::compress(&difference, 3).unwrap_or_default()
}

/// Decodes what [`encode`] wrote.
pub fn decode(plane: &[u8], nodes: &[i32]) -> Result<Vec<u8>, CodecError> {
    let mut codes = local(nodes);
    if plane.is_empty() {
        return Ok(codes);
    }
    let count = new_nodes().count();
    let difference = zstd::bulk::decompress(plane, count).map_err(|_| CodecError::Frame)?;
    if difference.len() != count {
        return Err(CodecError::Truncated);
    }
    for (k, d) in new_nodes().zip(difference) {
        codes[k] = codes[k].wrapping_add(d);
    }
    Ok(codes)
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
            for k in new_nodes() {
                codes[k] = codes[k].wrapping_add((k as u8) & noise);
            }
            prop_assert_eq!(decode(&encode(&codes, &nodes), &nodes).unwrap(), codes);
        }
    }

    #[test]
    fn damaged_frames_are_refused() {
        let nodes = vec![0; NODES];
        assert_eq!(decode(&[9, 9, 9], &nodes), Err(CodecError::Frame));
        assert_eq!(decode(&zstd::bulk::compress(&[1; 9], 1).unwrap(), &nodes), Err(CodecError::Truncated));
    }
}
