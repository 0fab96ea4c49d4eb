//! What the codec offers, and plain zstd beside it: the same heights coded in several ways.
//!
//! Each tile is coded and decoded by itself on one thread, and its times are summed: speeds are
//! those of one thread, without reading, resampling, deriving or writing.

use std::time::Instant;

use rayon::prelude::*;
use relief_formats::codec::{deviation, filled, hext, mip, nodes};
use relief_formats::file::{Entry, FormatError, Plane, Relief};
use relief_formats::tile::{TILE_CELLS, TILE_NODES};
use relief_formats::tile_planes::{TileSamples, encode};
use relief_formats::tiles::Tiles;

/// Decoded samples that are kept, bytes.
const CACHE_BYTES: u64 = 64 << 20;

/// One way of coding.
#[derive(Clone, Debug, PartialEq)]
pub struct Codec {
    /// Its name.
    pub name: &'static str,
    /// What one has after decoding.
    pub holds: &'static str,
    /// Bytes.
    pub bytes: u64,
    /// Level-0 nodes.
    pub nodes: u64,
    /// Seconds of one thread to code all.
    pub encode_s: f64,
    /// Seconds of one thread to decode all.
    pub decode_s: f64,
    /// It codes the heights and nothing else.
    pub heights_only: bool,
}

#[derive(Clone, Copy, Default)]
struct Cost {
    bytes: u64,
    encode_s: f64,
    decode_s: f64,
}

const WAYS: [(&str, &str, bool); 6] = [
    ("relief, heights", "every level", true),
    ("relief, heights and means", "every level, mip pyramid", false),
    ("relief, everything", "the whole file: bounds, deviations, masks, mesh too", false),
    ("zstd -3", "level 0 only", true),
    ("zstd -9", "level 0 only", true),
    ("zstd -9 of differences", "level 0 only", true),
];

/// Codes a file's tiles in every way.
///
/// # Errors
/// A damaged tile.
pub fn compare(relief: &Relief) -> Result<Vec<Codec>, FormatError> {
    let tiles = Tiles::new(relief, CACHE_BYTES).trusting();
    let entries = relief.entries().collect::<Result<Vec<_>, _>>()?;
    let found: Vec<[Cost; 6]> = entries.par_iter().map(|entry| tile(&tiles, entry)).collect::<Result<_, _>>()?;
    let planes: u64 = entries.iter().map(Entry::bytes).sum();
    let finest = entries.iter().filter(|entry| entry.key.level == 0).count() as u64;
    let ways = WAYS.iter().enumerate().map(|(way, &(name, holds, heights_only))| {
        let sum = found.iter().fold(Cost::default(), |sum, tile| Cost {
            bytes: sum.bytes + tile[way].bytes,
            encode_s: sum.encode_s + tile[way].encode_s,
            decode_s: sum.decode_s + tile[way].decode_s,
        });
        // Everything is also header, index, mesh and metadata, which cost no time to speak of.
        let bytes = if way == 2 { sum.bytes + relief.header().file_bytes - planes } else { sum.bytes };
        Codec {
            name,
            holds,
            bytes,
            nodes: finest * u64::from(TILE_CELLS) * u64::from(TILE_CELLS),
            encode_s: sum.encode_s,
            decode_s: sum.decode_s,
            heights_only,
        }
    });
    Ok(ways.collect())
}

fn tile(tiles: &Tiles<'_>, entry: &Entry) -> Result<[Cost; 6], FormatError> {
    let (relief, key) = (tiles.relief(), entry.key);
    let root = key.level == relief.grid().root_level();
    let (heights, means) = (tiles.nodes(key)?, tiles.mip(key)?);
    let (even, parent_mean) = if root {
        (Vec::new(), None)
    } else {
        let quarter = |samples: &[i32]| nodes::quarter(samples, key.quadrant());
        (quarter(&tiles.nodes(key.parent())?), Some(quarter(&tiles.mip(key.parent())?)))
    };
    let damaged = |plane: Plane| move |error| FormatError::Tile { key, plane: plane.name(), error };
    let node_mean = parent_mean.as_deref().filter(|_| key.level == 0);
    let mut costs = [Cost::default(); 6];

    let encode_nodes =
        |mean: Option<&[i32]>| if root { nodes::encode_root(&heights) } else { nodes::encode(&heights, mean) };
    let decode_nodes = |bytes: &[u8], mean: Option<&[i32]>| {
        let samples = if root { nodes::decode_root(bytes) } else { nodes::decode(bytes, &even, mean) };
        samples.map_err(damaged(Plane::Nodes))
    };
    let (bytes, encode_s) = timed(|| encode_nodes(None));
    let (decoded, decode_s) = timed(|| decode_nodes(&bytes, None));
    decoded?;
    costs[0] = Cost { bytes: bytes.len() as u64, encode_s, decode_s };

    let ((node_plane, mip_plane), encode_s) = timed(|| {
        let mip_plane = match key.level {
            0 => Vec::new(),
            _ => mip::encode(&means, &heights, parent_mean.as_deref()),
        };
        (encode_nodes(node_mean), mip_plane)
    });
    let (decoded, decode_s) = timed(|| {
        if key.level > 0 {
            mip::decode(&mip_plane, &heights, parent_mean.as_deref()).map_err(damaged(Plane::Mip))?;
        }
        decode_nodes(&node_plane, node_mean)
    });
    decoded?;
    costs[1] = Cost { bytes: (node_plane.len() + mip_plane.len()) as u64, encode_s, decode_s };

    let extremes = tiles.extremes(key)?;
    let deviations = tiles.deviations(key)?.unwrap_or_default();
    let mask = tiles.filled(key)?;
    let samples = TileSamples {
        key,
        root,
        nodes: &heights,
        mip: &means,
        parent_mean: parent_mean.as_deref(),
        extremes: &extremes,
        deviations: &deviations,
        filled: &mask,
    };
    let (_, encode_s) = timed(|| encode(&samples));
    let (decoded, rest_s) = timed(|| {
        hext::decode(relief.plane_bytes(entry, Plane::Hext), &heights).map_err(damaged(Plane::Hext))?;
        deviation::decode(relief.plane_bytes(entry, Plane::Deviation), &heights, root)
            .map_err(damaged(Plane::Deviation))?;
        filled::decode(relief.plane_bytes(entry, Plane::Filled)).map_err(damaged(Plane::Filled))
    });
    decoded?;
    costs[2] = Cost { bytes: entry.bytes(), encode_s, decode_s: decode_s + rest_s };

    if key.level == 0 {
        let wide = i16::try_from(relief.header().min_q).is_err() || i16::try_from(relief.header().max_q).is_err();
        for (way, level, differences) in [(3, 3, false), (4, 9, false), (5, 9, true)] {
            costs[way] = zstd_cost(&heights, wide, level, differences);
        }
    }
    Ok(costs)
}

/// The tile's own 256 x 256 nodes as 16-bit samples (32-bit ones where the file needs them),
/// as they are or as differences along the rows.
fn zstd_cost(heights: &[i32], wide: bool, level: i32, differences: bool) -> Cost {
    let cells = TILE_CELLS as usize;
    let (frame, encode_s) = timed(|| {
        let rows = heights.chunks_exact(TILE_NODES).take(cells);
        let samples = rows.flat_map(|row| {
            (0..cells).map(|x| if differences && x > 0 { row[x].wrapping_sub(row[x - 1]) } else { row[x] })
        });
        let raw: Vec<u8> = if wide {
            samples.flat_map(i32::to_le_bytes).collect()
        } else {
            samples.flat_map(|q| (q as i16).to_le_bytes()).collect()
        };
        zstd::bulk::compress(&raw, level)
    });
    // Compression into memory fails only without memory; then there is nothing to time.
    let Ok(frame) = frame else { return Cost::default() };
    let (_, decode_s) = timed(|| {
        let raw = zstd::bulk::decompress(&frame, cells * cells * 4).unwrap_or_default();
        let sample = |b: &[u8]| match *b {
            [a, b] => i32::from(i16::from_le_bytes([a, b])),
            [a, b, c, d] => i32::from_le_bytes([a, b, c, d]),
            _ => 0,
        };
        let size = if wide { 4 } else { 2 };
        let mut samples: Vec<i32> = raw.chunks_exact(size).map(sample).collect();
        if differences {
            for row in samples.chunks_mut(cells) {
                for x in 1..row.len() {
                    row[x] = row[x].wrapping_add(row[x - 1]);
                }
            }
        }
        samples
    });
    Cost { bytes: frame.len() as u64, encode_s, decode_s }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = std::hint::black_box(work());
    (result, start.elapsed().as_secs_f64())
}
