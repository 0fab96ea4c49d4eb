//! Pages: decoded tiles in fixed slots, found through a hash table by (level, column, row).
//!
//! The same buffers lie in the GPU's memory and, for the twins, in RAM. Every height is fetched
//! through them. A page that is asked for is recorded, present or not: from that list the
//! residency knows what a frame uses and what it lacks.

use std::sync::atomic::{AtomicU32, Ordering};

use bytemuck::{Pod, Zeroable};

use crate::planet::Planet;

/// Cells along a tile's side.
pub const CELLS: u32 = 256;
/// Nodes along a tile's side.
pub const NODES: u32 = 257;
/// H_ext entries along a tile's side.
pub const BLOCKS: u32 = 128;
/// Words of a slot in the buffer of heights: f32 metres, 257 rows from the south.
pub const HEIGHT_WORDS: u32 = NODES * NODES;
/// Words of H_ext in a slot of the buffer of bounds: (least, greatest) f32 metres of 128 x 128
/// blocks of 2 x 2 cells.
pub const EXTREME_WORDS: u32 = 2 * BLOCKS * BLOCKS;
/// Words of a slot in the buffer of bounds: H_ext, then the nodes' deviation codes, four a word,
/// the first lowest. In a page of the coarsest level the even nodes' codes are those of the levels
/// above it (`relief_formats::derive::crown`), so that bisection may start from whole squares.
pub const BOUND_WORDS: u32 = EXTREME_WORDS + NODES * NODES / 4 + 1;
/// No page; also an empty entry of the table.
pub const NONE: u32 = u32::MAX;
/// In a page's word: its slot.
pub const SLOT_MASK: u32 = 0x7fff_ffff;
/// In a page's word: its nodes may be activated. A page is usable when all pages of the next
/// coarser level that touch it are usable, so refinement never outruns what its parents need.
pub const USABLE: u32 = 0x8000_0000;
/// Entries looked at before the table gives up; the residency never lets a chain grow longer.
pub const PROBES: u32 = 32;

/// The key of a tile: level, row, column in 5, 12 and 13 bits.
#[must_use]
pub const fn key(level: u32, x: u32, y: u32) -> u32 {
    (level << 25) | (y << 13) | x
}

/// (level, column, row) of a key.
#[must_use]
pub const fn unkey(key: u32) -> (u32, u32, u32) {
    (key >> 25, key & 0x1fff, (key >> 13) & 0xfff)
}

/// Where the search for a key starts in a table of 2^bits entries.
#[must_use]
pub const fn hash(key: u32, bits: u32) -> u32 {
    key.wrapping_mul(0x9e37_79b1) >> (32 - bits)
}

/// A point whose height is asked for: `struct Point` of `wgsl/heights.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Point {
    /// Fixed point.
    pub s: u32,
    /// Fixed point.
    pub t: u32,
    /// Level of the surface that is asked for.
    pub level: u32,
    /// The answer, metres.
    pub height_m: f32,
}

/// A node or cell corner within a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TilePlace {
    /// The tile's column.
    pub x: u32,
    /// The tile's row.
    pub y: u32,
    /// Node column within the tile.
    pub column: u32,
    /// Node row within the tile.
    pub row: u32,
}

/// The buffers, as the kernels see them.
#[derive(Clone, Copy)]
pub struct Pages<'a> {
    /// The planet.
    pub planet: &'a Planet,
    /// (key, page word) in 2^`table_bits` entries.
    pub table: &'a [[u32; 2]],
    /// Slots of [`HEIGHT_WORDS`].
    pub heights: &'a [f32],
    /// Slots of [`BOUND_WORDS`].
    pub bounds: &'a [u32],
    /// Keys + 1 of pages asked for, in 2^`seen_bits` entries; 0 is empty.
    pub seen: &'a [AtomicU32],
}

impl Pages<'_> {
    /// The page word of a tile, or [`NONE`].
    #[must_use]
    pub fn find(&self, level: u32, x: u32, y: u32) -> u32 {
        let wanted = key(level, x, y);
        let mask = (1 << self.planet.table_bits) - 1;
        let mut at = hash(wanted, self.planet.table_bits);
        for _ in 0..PROBES {
            let entry = self.table[at as usize];
            if entry[0] == wanted {
                return entry[1];
            }
            if entry[0] == NONE {
                return NONE;
            }
            at = (at + 1) & mask;
        }
        NONE
    }

    /// Records that a page is used or lacking. When the record is full the page is asked for
    /// again by a later frame.
    pub fn ask(&self, level: u32, x: u32, y: u32) {
        let wanted = key(level, x, y) + 1;
        let mask = (1 << self.planet.seen_bits) - 1;
        let mut at = hash(wanted, self.planet.seen_bits);
        for _ in 0..PROBES {
            let cell = &self.seen[at as usize];
            let found = cell.load(Ordering::Relaxed);
            if found == wanted {
                return;
            }
            if found == 0 {
                match cell.compare_exchange(0, wanted, Ordering::Relaxed, Ordering::Relaxed) {
                    Ok(_) => return,
                    Err(other) if other == wanted => return,
                    Err(_) => {}
                }
            }
            at = (at + 1) & mask;
        }
    }

    /// Columns of tiles of a level.
    #[must_use]
    pub fn tiles_x(&self, level: u32) -> u32 {
        1 << (self.planet.root_level - level + 1 - self.planet.plane)
    }

    /// Rows of tiles of a level.
    #[must_use]
    pub fn tiles_y(&self, level: u32) -> u32 {
        1 << (self.planet.root_level - level)
    }

    /// The tile and the node of `level` at or south-west of (S, T). On the far edge (North Pole,
    /// a plane's edges) the last tile's last node.
    #[must_use]
    pub fn place(&self, level: u32, s: u32, t: u32) -> TilePlace {
        let shift = 31 - self.planet.m + level;
        let (i, j) = (s >> shift, t >> shift);
        let x = (i >> 8).min(self.tiles_x(level) - 1);
        let y = (j >> 8).min(self.tiles_y(level) - 1);
        TilePlace { x, y, column: i - (x << 8), row: j - (y << 8) }
    }

    /// Height of a node of a page, metres.
    #[must_use]
    pub fn node_m(&self, slot: u32, column: u32, row: u32) -> f32 {
        self.heights[(slot * HEIGHT_WORDS + row * NODES + column) as usize]
    }

    /// (least, greatest) height of S_0 over a block of 2 x 2 cells of a page, metres.
    #[must_use]
    pub fn extremes_m(&self, slot: u32, x: u32, y: u32) -> [f32; 2] {
        let at = (slot * BOUND_WORDS + 2 * (y * BLOCKS + x)) as usize;
        [f32::from_bits(self.bounds[at]), f32::from_bits(self.bounds[at + 1])]
    }

    /// Deviation of a node of a page, metres: an upper bound.
    #[must_use]
    pub fn deviation_m(&self, slot: u32, column: u32, row: u32) -> f32 {
        let k = row * NODES + column;
        let code = (self.bounds[(slot * BOUND_WORDS + EXTREME_WORDS + k / 4) as usize] >> (8 * (k % 4))) & 255;
        if code == 0 { 0.0 } else { f32::from_bits((code + 495) << 21) * self.planet.step_m }
    }

    /// Height of the surface at (S, T), metres, from the finest page at `level` or coarser. The
    /// page is asked for.
    #[must_use]
    pub fn height_m(&self, level: u32, s: u32, t: u32) -> f32 {
        let mut k = level;
        let first = self.place(k, s, t);
        self.ask(k, first.x, first.y);
        loop {
            let at = self.place(k, s, t);
            let page = self.find(k, at.x, at.y);
            if page != NONE {
                return self.bilinear_m(page & SLOT_MASK, k, at, s, t);
            }
            if k >= self.planet.root_level {
                return 0.0;
            }
            k += 1;
        }
    }

    /// Bilinear height in the cell at a place; at a node and along a cell's side the same bits
    /// whichever cell is asked.
    #[must_use]
    pub fn bilinear_m(&self, slot: u32, level: u32, at: TilePlace, s: u32, t: u32) -> f32 {
        let shift = 31 - self.planet.m + level;
        let mask = ((1u64 << shift) - 1) as u32;
        let scale = 1.0 / (mask as f32 + 1.0);
        let (u, v) = ((s & mask) as f32 * scale, (t & mask) as f32 * scale);
        let east = (at.column + 1).min(CELLS);
        let north = (at.row + 1).min(CELLS);
        let (h00, h10) = (self.node_m(slot, at.column, at.row), self.node_m(slot, east, at.row));
        let (h01, h11) = (self.node_m(slot, at.column, north), self.node_m(slot, east, north));
        let (south, north) = (h00 + (h10 - h00) * u, h01 + (h11 - h01) * u);
        south + (north - south) * v
    }
}
