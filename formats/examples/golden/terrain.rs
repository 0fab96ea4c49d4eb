//! Heights in integers only, so that every machine makes the same golden files.

use relief_formats::grid::Grid;

/// Which difficulties a map has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Smooth land, a flat sea, a few spikes of 9 km.
    Seas,
    /// Rough land everywhere.
    Rough,
    /// The largest samples there are, a checkerboard, a flat half.
    Extremes,
}

/// The height of node (i, j) of level 0, in steps; i from 0 to W - 1, j from 0 to H.
pub fn height_q(grid: Grid, kind: Kind, i: u32, j: u32) -> i32 {
    let (width, height) = (grid.width(0), grid.height(0));
    let octaves = match kind {
        Kind::Rough => 0..8,
        Kind::Seas => 2..8,
        Kind::Extremes => 4..8,
    };
    let land: i64 = octaves.map(|o| value_noise(o, i, j, width)).sum();
    let q = match kind {
        Kind::Seas if hash(i, j, 77).is_multiple_of(5000) => 144_000,
        Kind::Seas => land.max(-100),
        Kind::Rough => land / 4,
        Kind::Extremes if j < height / 2 => -11_000,
        Kind::Extremes if (96..128).contains(&i) && j > 192 => [-8_388_607, 8_388_607][(i + j) as usize % 2],
        Kind::Extremes => land,
    };
    // A pole is one node: rows fade towards it.
    let fade = if grid.plane { 32 } else { i64::from(j.min(height - j).min(32)) };
    (q * fade / 32) as i32 + if grid.plane { 0 } else { 77 }
}

/// Whether node (i, j) of level 0 is filled: a block, a sprinkle and a stripe.
pub fn filled(grid: Grid, i: u32, j: u32) -> bool {
    let block = (40..90).contains(&i) && (100..130).contains(&j);
    let stripe = grid.m > 9 && (512..=768).contains(&i) && j <= 256;
    let pole = j == 0 || j == grid.height(0);
    !pole && (block || stripe || hash(i, j, 5).is_multiple_of(997))
}

/// Bilinear noise between hashed values on a lattice of 2^octave nodes, wrapped at `width`.
fn value_noise(octave: u32, i: u32, j: u32, width: u32) -> i64 {
    let (size, columns) = (1i64 << octave, width >> octave);
    let at = |x: u32, y: u32| i64::from(hash(x % columns, y, octave) >> 16) - 32_768;
    let (x, y) = (i >> octave, j >> octave);
    let (u, v) = (i64::from(i) & (size - 1), i64::from(j) & (size - 1));
    let south = at(x, y) * (size - u) + at(x + 1, y) * u;
    let north = at(x, y + 1) * (size - u) + at(x + 1, y + 1) * u;
    ((south * (size - v) + north * v) >> (2 * octave)) >> (12 - octave)
}

fn hash(x: u32, y: u32, seed: u32) -> u32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}
