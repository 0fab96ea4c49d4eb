//! What a fuzzer drives: each function takes any bytes, and panics only when the reader is wrong.

use relief_formats::codec::nodes::{HALF, SAMPLE_LIMIT};
use relief_formats::codec::{deviation, filled, hext, mip, nodes};
use relief_formats::file::index::{Digest, digest};
use relief_formats::file::{FormatError, Metadata, Relief};
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

const SIDE: usize = 2 * HALF + 1;

/// Opens a file and reads some of it: as it is, and again with all checksums repaired and the
/// digests of samples not looked at, so that damage reaches the decoders.
pub fn open_and_read(data: &[u8]) {
    if let Ok(relief) = Relief::from_bytes(data) {
        let _ = read_all(&relief, &Tiles::new(&relief, 0), 8);
    }
    if let Ok(relief) = Relief::from_bytes(&repaired(data)) {
        let _ = read_all(&relief, &Tiles::new(&relief, 0).trusting(), 8);
    }
}

/// Digests of the mesh and of every plane of the first tiles of the map, present or absent.
///
/// # Errors
/// The first thing that cannot be read.
pub fn read_all(relief: &Relief, tiles: &Tiles<'_>, limit: usize) -> Result<Vec<Digest>, FormatError> {
    let mesh = relief.patch_mesh()?;
    let mut out = vec![digest_of(&mesh.indices), digest_of(&mesh.s_axis), digest_of(&mesh.t_axis)];
    let grid = relief.grid();
    let keys = (0..=grid.root_level()).rev().flat_map(|level| {
        (0..grid.tiles_y(level)).flat_map(move |y| (0..grid.tiles_x(level)).map(move |x| TileKey::new(level, x, y)))
    });
    for key in keys.take(limit) {
        let nodes = tiles.nodes(key)?;
        check_samples(&nodes);
        let means = tiles.mip(key)?;
        check_samples(&means);
        let bounds = tiles.extremes(key)?;
        assert_eq!(bounds.len(), HALF * HALF, "bounds of {key:?}");
        assert!(bounds.iter().all(|b| b.min <= b.max), "bounds of {key:?} are empty");
        let bounds: Vec<u32> = bounds.iter().flat_map(|b| [b.min as u32, b.max as u32]).collect();
        let deviations = tiles.deviations(key)?.unwrap_or_default();
        let filled = filled::pack(&tiles.filled(key)?);
        let words = |samples: &[i32]| digest_of(&samples.iter().map(|&q| q as u32).collect::<Vec<_>>());
        out.extend([words(&nodes), words(&means), digest_of(&bounds), digest(&deviations), digest(&filled)]);
    }
    Ok(out)
}

fn digest_of(words: &[u32]) -> Digest {
    digest(&words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>())
}

fn check_samples(samples: &[i32]) {
    assert_eq!(samples.len(), TILE_NODES * TILE_NODES, "a tile's samples");
    assert!(samples.iter().all(|q| (-SAMPLE_LIMIT..=SAMPLE_LIMIT).contains(q)), "a sample is out of range");
}

/// The bytes of any plane: the first byte chooses which, the second the terrain around it.
pub fn plane_nodes(data: &[u8]) {
    let Some((&[plane, terrain], bytes)) = data.split_first_chunk() else { return };
    let around = |side: usize| -> Vec<i32> {
        let height = |k: usize| match terrain % 3 {
            0 => 0,
            1 => ((k * k) as i32 & 0x3ff) - 100 * (k % side) as i32,
            _ => {
                if k.is_multiple_of(2) {
                    SAMPLE_LIMIT
                } else {
                    -SAMPLE_LIMIT
                }
            }
        };
        (0..side * side).map(height).collect()
    };
    let (own, quarter) = (around(SIDE), around(HALF + 1));
    let mean = (terrain & 4 != 0).then_some(quarter.as_slice());
    let root = terrain & 8 != 0;
    match plane % 6 {
        0 => {
            if let Ok(samples) = nodes::decode_root(bytes) {
                check_samples(&samples);
                assert_eq!(nodes::decode_root(&nodes::encode_root(&samples)).as_ref(), Ok(&samples));
            }
        }
        1 => {
            if let Ok(samples) = nodes::decode(bytes, &quarter, mean) {
                check_samples(&samples);
                assert_eq!(nodes::decode(&nodes::encode(&samples, mean), &quarter, mean).as_ref(), Ok(&samples));
            }
        }
        2 => {
            if let Ok(samples) = mip::decode(bytes, &own, mean) {
                check_samples(&samples);
                assert_eq!(mip::decode(&mip::encode(&samples, &own, mean), &own, mean).as_ref(), Ok(&samples));
            }
        }
        3 => {
            if let Ok(bounds) = hext::decode(bytes, &own) {
                let inner = hext::of_nodes(&own);
                assert!(bounds.iter().zip(&inner).all(|(b, n)| b.min <= n.min && n.max <= b.max));
            }
        }
        4 => {
            if let Ok(codes) = deviation::decode(bytes, &own, root) {
                let again = deviation::encode(&codes, &own, root);
                assert_eq!(deviation::decode(&again, &own, root), Ok(codes));
            }
        }
        _ => {
            if let Ok(marks) = filled::decode(bytes) {
                assert_eq!(filled::decode(&filled::encode(&marks)), Ok(marks));
            }
        }
    }
}

/// The content of a mesh section, and the section itself.
pub fn mesh(data: &[u8]) {
    let _ = relief_formats::mesh::decode_section(data);
    if let Ok(mesh) = relief_formats::mesh::decode(data) {
        assert_eq!(relief_formats::mesh::encode(&mesh), data, "a mesh has one encoding");
        let _ = relief_formats::mesh::check_mesh(&mesh, &relief_formats::body::Body::earth());
    }
}

/// The metadata section.
pub fn metadata(data: &[u8]) {
    if let Ok(metadata) = Metadata::decode(data) {
        let canonical = metadata.encode().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Metadata::decode(&canonical).ok(), Some(metadata), "metadata come back");
    }
}

/// The same bytes with every checksum made right, as far as header and table make sense.
#[must_use]
pub fn repaired(data: &[u8]) -> Vec<u8> {
    let mut data = data.to_vec();
    let length = data.len();
    if length < 256 + 64 {
        return data;
    }
    let u64_at = |data: &[u8], at: usize| data[at..].first_chunk().map_or(0, |raw| u64::from_le_bytes(*raw));
    let rows = (u64_at(&data, 96) as u32 as usize).min((length - 256 - 64) / 64);
    for row in (0..rows).map(|k| 256 + 64 * k) {
        let (start, size) = (u64_at(&data, row + 8), u64_at(&data, row + 16));
        let Some(end) = start.checked_add(size).filter(|&end| end <= length as u64) else { continue };
        let section = start as usize..end as usize;
        if data[row..row + 4] == *b"INDX" {
            for entry in data[section.clone()].chunks_exact_mut(128) {
                entry[44..48].fill(0);
                let check = *blake3::hash(entry).as_bytes();
                entry[44..48].copy_from_slice(&check[..4]);
            }
        }
        if data[row..row + 4] != *b"TILE" {
            let hash = *blake3::hash(&data[section]).as_bytes();
            data[row + 32..row + 64].copy_from_slice(&hash);
        }
    }
    let table = *blake3::hash(&data[256..256 + 64 * rows]).as_bytes();
    data[80..88].copy_from_slice(&(length as u64).to_le_bytes());
    data[168..200].copy_from_slice(&table);
    let header = *blake3::hash(&data[..224]).as_bytes();
    data[224..256].copy_from_slice(&header);
    let tail = length - 64;
    data[tail..tail + 8].copy_from_slice(b"\n\x1a\n\rFLR\x89");
    data[tail + 8..tail + 16].copy_from_slice(&(length as u64).to_le_bytes());
    data[tail + 16..tail + 48].copy_from_slice(&header);
    data[tail + 48..].fill(0);
    data
}
