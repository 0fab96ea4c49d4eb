//! The plane `filled`: one bit for each of a tile's 257 x 257 nodes, lowest bit first.

use super::{CodecError, frame};
use crate::tile::TILE_NODES;

/// Bytes of the packed bits.
pub const PACKED_BYTES: usize = (TILE_NODES * TILE_NODES).div_ceil(8);

/// The packed bits, which are also what the plane's digest is taken of.
#[must_use]
pub fn pack(filled: &[bool]) -> Vec<u8> {
    filled.chunks(8).map(|bits| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit))).collect()
}

/// Encodes: nothing when no node is filled, one byte when all are, else a zstd frame of the bits.
#[must_use]
pub fn encode(filled: &[bool]) -> Vec<u8> {
    if !filled.contains(&true) {
        Vec::new()
    } else if !filled.contains(&false) {
        vec![1]
    } else {
        frame::compress_runs(&pack(filled))
    }
}

/// Decodes what [`encode`] wrote.
pub fn decode(plane: &[u8]) -> Result<Vec<bool>, CodecError> {
    let nodes = TILE_NODES * TILE_NODES;
    match plane {
        [] => Ok(vec![false; nodes]),
        [1] => Ok(vec![true; nodes]),
        _ => {
            let bytes = zstd::bulk::decompress(plane, PACKED_BYTES).map_err(|_| CodecError::Frame)?;
            if bytes.len() != PACKED_BYTES {
                return Err(CodecError::Truncated);
            }
            if bytes[PACKED_BYTES - 1] >> (nodes % 8) != 0 {
                return Err(CodecError::Trailing);
            }
            Ok((0..nodes).map(|k| bytes[k / 8] >> (k % 8) & 1 == 1).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_of_none_all_and_some() {
        let nodes = TILE_NODES * TILE_NODES;
        for filled in [vec![false; nodes], vec![true; nodes], (0..nodes).map(|k| k % 7 == 0).collect()] {
            assert_eq!(decode(&encode(&filled)).unwrap(), filled);
        }
    }

    #[test]
    fn junk_is_refused() {
        assert_eq!(decode(&[2]), Err(CodecError::Frame));
        assert_eq!(decode(&zstd::bulk::compress(&[0; 9], 1).unwrap()), Err(CodecError::Truncated));
        let padded = zstd::bulk::compress(&[0xff; PACKED_BYTES], 1).unwrap();
        assert_eq!(decode(&padded), Err(CodecError::Trailing));
    }
}
