//! The sorted sparse tile index (SPEC, "Index").

use super::FormatError;
use super::header::array;
use crate::grid::Grid;
use crate::tile::TileKey;

/// Bytes of an entry.
pub const ENTRY_BYTES: usize = 128;

/// A tile's planes, in the order their bytes follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Plane {
    /// Heights of S_0 at the tile's 257 x 257 nodes.
    Nodes,
    /// Filtered means at the same nodes; absent at level 0, where they are the nodes.
    Mip,
    /// H_ext: 128 x 128 pairs of extremes of S_0 over 2 x 2 cells of the tile.
    Hext,
    /// Deviation codes of the nodes that are new at the tile's level.
    Deviation,
    /// Which nodes are filled rather than measured.
    Filled,
}

impl Plane {
    /// All planes in file order.
    pub const ALL: [Self; 5] = [Self::Nodes, Self::Mip, Self::Hext, Self::Deviation, Self::Filled];

    /// Its name on command lines and in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nodes => "nodes",
            Self::Mip => "mip",
            Self::Hext => "hext",
            Self::Deviation => "deviation",
            Self::Filled => "filled",
        }
    }
}

/// The first 16 bytes of the BLAKE3 hash of a plane's decoded samples.
pub type Digest = [u8; 16];

/// Where a tile is and what it decodes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Which tile.
    pub key: TileKey,
    /// First byte of its planes, from the start of the tile section.
    pub offset: u64,
    /// Bytes of each plane.
    pub lengths: [u32; 5],
    /// Smallest node of the tile, in steps.
    pub min_q: i32,
    /// Largest node of the tile, in steps.
    pub max_q: i32,
    /// Digest of each plane's decoded samples.
    pub digests: [Digest; 5],
}

impl Entry {
    /// The sort key: coarsest level first, then Morton.
    #[must_use]
    pub const fn sort_key(key: TileKey) -> u64 {
        ((31 - key.level as u64) << 56) | key.morton()
    }

    /// The entry's bytes; bytes 44 to 48 are its own checksum, so that a search notices a damaged
    /// key without a pass over the whole index.
    #[must_use]
    pub fn encode(&self) -> [u8; ENTRY_BYTES] {
        let mut bytes = [0; ENTRY_BYTES];
        bytes[..8].copy_from_slice(&Self::sort_key(self.key).to_le_bytes());
        bytes[8..16].copy_from_slice(&self.offset.to_le_bytes());
        for (k, length) in self.lengths.iter().enumerate() {
            bytes[16 + 4 * k..20 + 4 * k].copy_from_slice(&length.to_le_bytes());
        }
        bytes[36..40].copy_from_slice(&self.min_q.to_le_bytes());
        bytes[40..44].copy_from_slice(&self.max_q.to_le_bytes());
        for (k, digest) in self.digests.iter().enumerate() {
            bytes[48 + 16 * k..64 + 16 * k].copy_from_slice(digest);
        }
        let check = check(&bytes);
        bytes[CHECK].copy_from_slice(&check);
        bytes
    }

    /// Reads an entry of [`ENTRY_BYTES`]; its range must lie in a tile section of `tile_bytes`.
    pub fn decode(bytes: &[u8], grid: &Grid, tile_bytes: u64) -> Result<Self, FormatError> {
        let mut bare: [u8; ENTRY_BYTES] = array(bytes, 0);
        bare[CHECK].fill(0);
        if bytes[CHECK] != check(&bare) {
            return Err(FormatError::damaged("an index entry's checksum does not match"));
        }
        let sort_key = u64::from_le_bytes(array(bytes, 0));
        let level = 31 - ((sort_key >> 56) as u32).min(31);
        let key = TileKey::from_morton(level, sort_key & ((1 << 56) - 1));
        let entry = Self {
            key,
            offset: u64::from_le_bytes(array(bytes, 8)),
            lengths: std::array::from_fn(|k| u32::from_le_bytes(array(bytes, 16 + 4 * k))),
            min_q: i32::from_le_bytes(array(bytes, 36)),
            max_q: i32::from_le_bytes(array(bytes, 40)),
            digests: std::array::from_fn(|k| array(bytes, 48 + 16 * k)),
        };
        let end = entry.offset.checked_add(entry.bytes());
        if !grid.contains(key) || Self::sort_key(key) != sort_key || end.is_none_or(|end| end > tile_bytes) {
            return Err(FormatError::damaged("an index entry names a tile or bytes that cannot be"));
        }
        Ok(entry)
    }

    /// Bytes of all planes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.lengths.iter().map(|&l| u64::from(l)).sum()
    }

    /// Where a plane lies in the tile section.
    #[must_use]
    pub fn range(&self, plane: Plane) -> std::ops::Range<u64> {
        let before: u64 = self.lengths[..plane as usize].iter().map(|&l| u64::from(l)).sum();
        let start = self.offset + before;
        start..start + u64::from(self.lengths[plane as usize])
    }
}

/// Where an entry's checksum lies.
const CHECK: std::ops::Range<usize> = 44..48;

/// The first bytes of the hash of an entry whose checksum is zero.
fn check(entry: &[u8; ENTRY_BYTES]) -> [u8; 4] {
    array(blake3::hash(entry).as_bytes(), 0)
}

/// The digest of a plane's decoded samples.
#[must_use]
pub fn digest(samples: &[u8]) -> Digest {
    array(blake3::hash(samples).as_bytes(), 0)
}

/// The identity of a file's content: what the header means and what every tile decodes to.
pub fn content_id<'a>(identity: &[u8], entries: impl Iterator<Item = &'a Entry>) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(b"relief content 1");
    hasher.update(identity);
    for entry in entries {
        hasher.update(&Entry::sort_key(entry.key).to_le_bytes());
        for digest in &entry.digests {
            hasher.update(digest);
        }
    }
    *hasher.finalize().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_and_limits() {
        let grid = Grid::new(10, false);
        let entry = Entry {
            key: TileKey::new(1, 3, 1),
            offset: 1000,
            lengths: [10, 20, 30, 40, 50],
            min_q: -5,
            max_q: 9,
            digests: [[1; 16], [2; 16], [3; 16], [4; 16], [5; 16]],
        };
        assert_eq!(Entry::decode(&entry.encode(), &grid, 1150).unwrap(), entry);
        assert_eq!(entry.range(Plane::Hext), 1030..1060);
        assert!(Entry::decode(&entry.encode(), &grid, 1149).is_err());
        let far = Entry { key: TileKey::new(1, 4, 0), ..entry };
        assert!(Entry::decode(&far.encode(), &grid, 1150).is_err());
        let overflow = Entry { offset: u64::MAX, ..entry };
        assert!(Entry::decode(&overflow.encode(), &grid, 1150).is_err());
    }
    #[test]
    fn every_flipped_bit_is_refused() {
        let entry = Entry {
            key: TileKey::new(0, 1, 1),
            offset: 0,
            lengths: [1, 0, 1, 1, 1],
            min_q: 0,
            max_q: 0,
            digests: [[0; 16]; 5],
        };
        let bytes = entry.encode();
        assert_eq!(Entry::decode(&bytes, &Grid::new(10, false), 4).unwrap(), entry);
        for bit in 0..ENTRY_BYTES * 8 {
            let mut bad = bytes;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(Entry::decode(&bad, &Grid::new(10, false), u64::MAX).is_err(), "bit {bit}");
        }
    }
}
