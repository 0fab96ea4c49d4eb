//! All planes of one tile, encoded and decoded together.

use crate::codec::{deviation, filled, hext, mip, nodes};
use crate::derive::extremes::Extremes;
use crate::file::index::{Digest, digest};
use crate::tile::TileKey;

/// What a bake knows of a tile.
#[derive(Clone, Copy, Debug)]
pub struct TileSamples<'a> {
    /// Which tile.
    pub key: TileKey,
    /// True at the coarsest stored level.
    pub root: bool,
    /// Heights in steps, 257 x 257, south row first.
    pub nodes: &'a [i32],
    /// Filtered means at the same nodes; unused at level 0.
    pub mip: &'a [i32],
    /// The parent's filtered means at this tile's even nodes, 129 x 129; none for a root.
    pub parent_mean: Option<&'a [i32]>,
    /// True extremes, 128 x 128.
    pub extremes: &'a [Extremes],
    /// Deviation codes, 257 x 257; a root's with the crown's, see [`crate::derive::crown`].
    pub deviations: &'a [u8],
    /// Which nodes are filled, 257 x 257.
    pub filled: &'a [bool],
}

/// A tile as it lies in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedTile {
    /// Which tile.
    pub key: TileKey,
    /// Bytes of each plane, in file order.
    pub planes: [Vec<u8>; 5],
    /// Digests of the decoded samples.
    pub digests: [Digest; 5],
    /// Smallest node, in steps.
    pub min_q: i32,
    /// Largest node, in steps.
    pub max_q: i32,
}

/// Encodes a tile's planes.
#[must_use]
pub fn encode(tile: &TileSamples<'_>) -> EncodedTile {
    let finest = tile.key.level == 0;
    let nodes = if tile.root {
        nodes::encode_root(tile.nodes)
    } else {
        nodes::encode(tile.nodes, if finest { tile.parent_mean } else { None })
    };
    let mip = if finest { Vec::new() } else { mip::encode(tile.mip, tile.nodes, tile.parent_mean) };
    let (hext, bounds) = hext::encode(tile.extremes, tile.nodes);
    let deviation = deviation::encode(tile.deviations, tile.nodes, tile.root);
    let digests = [
        digest(bytemuck::cast_slice(&little_endian(tile.nodes))),
        if finest { Digest::default() } else { digest(bytemuck::cast_slice(&little_endian(tile.mip))) },
        digest(&hext_bytes(&bounds)),
        digest(tile.deviations),
        digest(&filled::pack(tile.filled)),
    ];
    let (min_q, max_q) = tile.nodes.iter().fold((i32::MAX, i32::MIN), |(low, high), &q| (low.min(q), high.max(q)));
    EncodedTile {
        key: tile.key,
        planes: [nodes, mip, hext, deviation, filled::encode(tile.filled)],
        digests,
        min_q,
        max_q,
    }
}

/// Samples as the digest sees them: little-endian on every machine.
pub(crate) fn little_endian(samples: &[i32]) -> std::borrow::Cow<'_, [i32]> {
    if cfg!(target_endian = "little") {
        samples.into()
    } else {
        samples.iter().map(|s| s.to_le()).collect::<Vec<_>>().into()
    }
}

/// Pairs (min, max), little-endian, as the digest sees them.
pub(crate) fn hext_bytes(bounds: &[Extremes]) -> Vec<u8> {
    bounds.iter().flat_map(|e| [e.min.to_le_bytes(), e.max.to_le_bytes()]).flatten().collect()
}
