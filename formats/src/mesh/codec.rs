//! The mesh section of a file. All numbers are little-endian.
//!
//! ```text
//! offset  size         field
//! 0       4            layout: 0 aligned, 1 paper
//! 4       4            m, the map exponent, at most 31
//! 8       4            columns, cells from west to east, 1 to 65535
//! 12      4            rows, cells from south to north, 1 to 65535
//! 16      4            index_count, a multiple of 3, at least (columns + 1) (rows + 1)
//! 20      4            reserved, 0
//! 24      4 columns+4  S of each meridian as u32, west to east; on a globe the last one is
//!                      2^32, which wraps to 0
//! ...     4 rows+4     T of each parallel as u32, south to north
//! ...     to the end   index_count vertex numbers, each coded as below
//! ```
//!
//! Vertex (i, j) is number v = i (columns + 1) + j and has S = `s_axis[j]`, T = `t_axis[i]` and
//! texture coordinates (j / columns, i / rows). Index k is coded as the difference d to index
//! k - 6, the same corner of the pair of triangles before (to 0 for k < 6), as a zigzag number
//! u = 2 d for d >= 0, else -2 d - 1, and u as LEB128: seven bits a byte, lowest first, the top
//! bit set on all but the last byte; at most five bytes, and no longer than needed. Neighbouring
//! pairs differ by one, so an index costs one byte, nearly all of them the byte 2.
//!
//! A reader MUST reject: a section shorter than its fields or with bytes left over; an unknown
//! layout; a reserved field that is not 0; counts outside the ranges above; an index not below
//! the vertex count; an over-long LEB128 number. Positions are not stored: they follow from
//! (S, T) in f64, so they carry no error but that of the fixed-point angle (none when aligned).

use super::{MeshLayout, PatchMesh};

/// Most columns, and most rows, that a section may have.
pub const MAX_CELLS: u32 = 65_535;
const HEADER_BYTES: usize = 24;
/// Indices of two triangles, the unit that repeats along a row.
const PAIR: usize = 6;

/// A mesh section that cannot be read: the file is damaged or no mesh at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// The bytes end early.
    #[error("mesh section ends at byte {have}, {need} are needed")]
    Truncated {
        /// Bytes there are.
        have: usize,
        /// Bytes needed at least.
        need: usize,
    },
    /// Bytes follow the last index.
    #[error("mesh section has {0} bytes after its last index")]
    Trailing(usize),
    /// A field outside its range.
    #[error("mesh section: {field} is {value}, must be {rule}")]
    Field {
        /// Which field.
        field: &'static str,
        /// Its value.
        value: u64,
        /// What it must be.
        rule: &'static str,
    },
    /// The zstd frame around the mesh is damaged, or holds more than a mesh can be.
    #[error("mesh section: damaged zstd frame")]
    Frame,
    /// An index that is over-long or names no vertex.
    #[error("mesh section: index {0} is over-long or not below the vertex count")]
    Index(u32),
}

/// The section's bytes.
#[must_use]
pub fn encode(mesh: &PatchMesh) -> Vec<u8> {
    let layout = match mesh.layout {
        MeshLayout::Aligned => 0,
        MeshLayout::Paper => 1,
    };
    let header = [layout, mesh.m, mesh.columns(), mesh.rows(), mesh.indices.len() as u32, 0];
    let axes = mesh.s_axis.iter().chain(&mesh.t_axis);
    let mut bytes: Vec<u8> = header.iter().chain(axes).flat_map(|word| word.to_le_bytes()).collect();
    bytes.reserve(mesh.indices.len() + 16);
    let mut last = [0i64; PAIR];
    for (k, &index) in mesh.indices.iter().enumerate() {
        let difference = i64::from(index) - last[k % PAIR];
        last[k % PAIR] = i64::from(index);
        let mut zigzag = ((difference << 1) ^ (difference >> 63)) as u64;
        while zigzag >= 0x80 {
            bytes.push(zigzag as u8 | 0x80);
            zigzag >>= 7;
        }
        bytes.push(zigzag as u8);
    }
    bytes
}

/// Reads a section. Allocates at most five bytes for each byte given; panics on nothing.
///
/// # Errors
/// Anything the module's text says a reader MUST reject.
pub fn decode(bytes: &[u8]) -> Result<PatchMesh, MeshError> {
    let (header, rest) =
        bytes.split_at_checked(HEADER_BYTES).ok_or(MeshError::Truncated { have: bytes.len(), need: HEADER_BYTES })?;
    let words = words(header);
    let &[layout, m, columns, rows, index_count, reserved] = words.as_slice() else {
        return Err(MeshError::Truncated { have: bytes.len(), need: HEADER_BYTES });
    };
    let field = |field, value: u32, rule| Err(MeshError::Field { field, value: u64::from(value), rule });
    let layout = match layout {
        0 => MeshLayout::Aligned,
        1 => MeshLayout::Paper,
        other => return field("layout", other, "0 or 1"),
    };
    if m > 31 {
        return field("m", m, "at most 31");
    }
    if !(1..=MAX_CELLS).contains(&columns) {
        return field("columns", columns, "1 to 65535");
    }
    if !(1..=MAX_CELLS).contains(&rows) {
        return field("rows", rows, "1 to 65535");
    }
    if reserved != 0 {
        return field("reserved", reserved, "0");
    }
    // At most 2^32, so an index of u32 may still be out of range: compare as u64.
    let vertex_count = u64::from(columns + 1) * u64::from(rows + 1);
    if index_count % 3 != 0 || u64::from(index_count) < vertex_count {
        return field("index_count", index_count, "a multiple of 3 and at least the number of vertices");
    }
    let axes_bytes = 4 * (columns as usize + rows as usize + 2);
    let need = HEADER_BYTES + axes_bytes + index_count as usize; // an index is a byte or more
    let truncated = MeshError::Truncated { have: bytes.len(), need };
    if bytes.len() < need {
        return Err(truncated);
    }
    let (axes, stream) = rest.split_at_checked(axes_bytes).ok_or(truncated)?;
    let (s_bytes, t_bytes) = axes.split_at_checked(4 * (columns as usize + 1)).ok_or(truncated)?;
    let indices = read_indices(stream, index_count, vertex_count)?;
    Ok(PatchMesh { layout, m, s_axis: self::words(s_bytes), t_axis: self::words(t_bytes), indices })
}

/// The mesh as a file's section holds it: the bytes of [`encode`] in one zstd frame.
#[must_use]
pub fn encode_section(mesh: &PatchMesh) -> Vec<u8> {
    // Compressing into memory cannot fail; an empty section would be refused by every reader.
    zstd::bulk::compress(&encode(mesh), 9).unwrap_or_default()
}

/// Reads a section. Allocates at most [`MAX_SECTION_BYTES`] and what [`decode`] does.
///
/// # Errors
/// A damaged frame, and anything [`decode`] refuses.
pub fn decode_section(frame: &[u8]) -> Result<PatchMesh, MeshError> {
    decode(&zstd::bulk::decompress(frame, MAX_SECTION_BYTES).map_err(|_| MeshError::Frame)?)
}

/// No mesh is larger than this before compression.
pub const MAX_SECTION_BYTES: usize = 1 << 20;

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect()
}

fn read_indices(stream: &[u8], count: u32, vertex_count: u64) -> Result<Vec<u32>, MeshError> {
    let mut indices = Vec::with_capacity(count as usize);
    let mut bytes = stream.iter();
    let mut last = [0i64; PAIR];
    for k in 0..count {
        let mut zigzag = 0u64;
        for shift in (0..).step_by(7) {
            let short = MeshError::Truncated { have: stream.len(), need: stream.len() + 1 };
            let &byte = bytes.next().ok_or(short)?;
            if shift == 35 || (shift > 0 && byte == 0) {
                return Err(MeshError::Index(k));
            }
            zigzag |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                break;
            }
        }
        let difference = (zigzag >> 1) as i64 ^ -((zigzag & 1) as i64);
        let index = last[k as usize % PAIR] + difference;
        let valid = u32::try_from(index).ok().filter(|&v| u64::from(v) < vertex_count);
        indices.push(valid.ok_or(MeshError::Index(k))?);
        last[k as usize % PAIR] = index;
    }
    match bytes.len() {
        0 => Ok(indices),
        extra => Err(MeshError::Trailing(extra)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::patch_mesh;
    use super::*;
    use crate::{body::Body, grid::Grid};
    use proptest::prelude::*;

    fn small() -> PatchMesh {
        patch_mesh(&Body::earth(), &Grid::new(8, false), MeshLayout::Aligned)
    }

    #[test]
    fn every_layout_comes_back() {
        let plane = Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: 1.0, dy: 1.0 };
        for m in [8, 9, 12, 13, 20] {
            for (body, layout) in [
                (Body::earth(), MeshLayout::Aligned),
                (Body::moon(), MeshLayout::Paper),
                (plane.clone(), MeshLayout::Aligned),
            ] {
                let mesh = patch_mesh(&body, &Grid::new(m, body.is_plane()), layout);
                let bytes = encode(&mesh);
                assert!(
                    bytes.len() < 24 + 4 * 400 + mesh.indices.len() + mesh.indices.len() / 50 + 40,
                    "{}",
                    bytes.len()
                );
                assert_eq!(decode(&bytes), Ok(mesh));
            }
        }
    }

    #[test]
    fn worked_example_of_the_text() {
        let bytes = encode(&small());
        assert_eq!(bytes[..24], [0, 0, 0, 0, 8, 0, 0, 0, 8, 0, 0, 0, 4, 0, 0, 0, 144, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(bytes[28..32], (1u32 << 29).to_le_bytes());
        // 0 10 9, 27 28 36, then 1 11 10, 28 29 37.
        assert_eq!(bytes[24 + 36 + 20..][..12], [0, 20, 18, 54, 56, 72, 2, 2, 2, 2, 2, 2]);
    }

    #[test]
    fn every_cut_and_every_addition_is_an_error() {
        let bytes = encode(&small());
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "cut at {length}");
        }
        let longer = [bytes.as_slice(), &[0]].concat();
        assert_eq!(decode(&longer), Err(MeshError::Trailing(1)));
    }

    #[test]
    fn fields_outside_their_range_are_named() {
        let broken = |at: usize, value: u32| {
            let mut bytes = encode(&small());
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            decode(&bytes).unwrap_err().to_string()
        };
        assert!(broken(0, 2).contains("layout"));
        assert!(broken(4, 32).contains("m is 32"));
        assert!(broken(8, 0).contains("columns"));
        assert!(broken(12, u32::MAX).contains("rows"));
        assert!(broken(16, 145).contains("index_count"));
        assert!(broken(20, 1).contains("reserved"));
        // Counts that the bytes have not earned.
        assert!(broken(16, 3_000_000_000).contains("are needed"));
        assert!(broken(8, 65_535).contains("index_count"));
    }

    #[test]
    fn bad_indices_are_refused() {
        let mut bytes = encode(&small());
        let start = 24 + 36 + 20;
        bytes[start] = 1; // -1
        assert_eq!(decode(&bytes), Err(MeshError::Index(0)));
        bytes[start] = 90; // 45, one past the last vertex
        assert_eq!(decode(&bytes), Err(MeshError::Index(0)));
        bytes.splice(start..=start, [0x80, 0]); // 0, written in two bytes
        assert_eq!(decode(&bytes), Err(MeshError::Index(0)));
        bytes.splice(start..start + 2, [0xff; 6]);
        assert_eq!(decode(&bytes), Err(MeshError::Index(0)));
    }

    proptest! {
        #[test]
        fn no_bytes_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..400), header: bool) {
            if header && bytes.len() >= 24 {
                bytes[..24].copy_from_slice(&encode(&small())[..24]);
            }
            if let Ok(mesh) = decode(&bytes) {
                prop_assert_eq!(encode(&mesh), bytes);
            }
        }

        #[test]
        fn a_flipped_bit_never_goes_unseen(at in 0usize..10_000, bit in 0u8..8) {
            let good = encode(&small());
            let mut bytes = good.clone();
            let at = at % bytes.len();
            bytes[at] ^= 1 << bit;
            prop_assert_ne!(decode(&bytes), Ok(small()));
        }
    }
}
