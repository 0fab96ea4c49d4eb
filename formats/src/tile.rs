//! Tiles of 256 x 256 cells and their keys.

/// Cells along a tile's side.
pub const TILE_CELLS: u32 = 256;
/// Nodes along a tile's side: both edges belong to the tile.
pub const TILE_NODES: usize = TILE_CELLS as usize + 1;

/// A tile of one level; (0, 0) is the south-west one. Ordered coarsest level first, then by
/// Morton number, which is the order of tiles in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TileKey {
    /// 0 is the finest level.
    pub level: u32,
    /// Column, eastwards.
    pub x: u32,
    /// Row, northwards.
    pub y: u32,
}

impl TileKey {
    /// A key; nothing is checked against a grid here.
    #[must_use]
    pub const fn new(level: u32, x: u32, y: u32) -> Self {
        Self { level, x, y }
    }

    /// The tile of the next coarser level that covers this one.
    #[must_use]
    pub const fn parent(self) -> Self {
        Self { level: self.level + 1, x: self.x / 2, y: self.y / 2 }
    }

    /// Which quarter of the parent this tile is: 0 or 1 eastwards, 0 or 1 northwards.
    #[must_use]
    pub const fn quadrant(self) -> (usize, usize) {
        ((self.x & 1) as usize, (self.y & 1) as usize)
    }

    /// The bits of x and y interleaved, x lowest.
    #[must_use]
    pub const fn morton(self) -> u64 {
        spread(self.x) | (spread(self.y) << 1)
    }

    /// Inverse of [`TileKey::morton`] at a level.
    #[must_use]
    pub const fn from_morton(level: u32, morton: u64) -> Self {
        Self { level, x: gather(morton), y: gather(morton >> 1) }
    }
}

impl Ord for TileKey {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.level.cmp(&self.level).then(self.morton().cmp(&other.morton()))
    }
}

impl PartialOrd for TileKey {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

const fn spread(v: u32) -> u64 {
    let mut v = v as u64;
    v = (v | (v << 16)) & 0x0000_ffff_0000_ffff;
    v = (v | (v << 8)) & 0x00ff_00ff_00ff_00ff;
    v = (v | (v << 4)) & 0x0f0f_0f0f_0f0f_0f0f;
    v = (v | (v << 2)) & 0x3333_3333_3333_3333;
    (v | (v << 1)) & 0x5555_5555_5555_5555
}

const fn gather(v: u64) -> u32 {
    let mut v = v & 0x5555_5555_5555_5555;
    v = (v | (v >> 1)) & 0x3333_3333_3333_3333;
    v = (v | (v >> 2)) & 0x0f0f_0f0f_0f0f_0f0f;
    v = (v | (v >> 4)) & 0x00ff_00ff_00ff_00ff;
    v = (v | (v >> 8)) & 0x0000_ffff_0000_ffff;
    ((v | (v >> 16)) & 0xffff_ffff) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn morton_is_invertible(level in 0u32..13, x: u32, y: u32) {
            let key = TileKey::new(level, x, y);
            prop_assert_eq!(TileKey::from_morton(level, key.morton()), key);
        }
    }

    #[test]
    fn coarse_tiles_sort_first() {
        assert!(TileKey::new(3, 0, 0) < TileKey::new(2, 0, 0));
        assert!(TileKey::new(2, 1, 0) < TileKey::new(2, 0, 1));
    }
}
