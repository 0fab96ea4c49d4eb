//! The section table (SPEC, "Sections"): what lies where, and its checksum.

use super::FormatError;
use super::header::array;

/// Bytes of a table row.
pub const ROW_BYTES: usize = 64;
/// Sections start at multiples of this; the bytes between are zero.
pub const ALIGNMENT: u64 = 64;
/// More sections than any version will have: a damaged count ends here.
pub const MAX_SECTIONS: u32 = 256;
/// Flag bit 0: a reader that does not know the kind must refuse the file.
pub const REQUIRED: u32 = 1;

/// Canonical JSON metadata.
pub const META: [u8; 4] = *b"META";
/// The ellipsoid patch mesh.
pub const MESH: [u8; 4] = *b"MESH";
/// The tile index of the height layer.
pub const INDEX: [u8; 4] = *b"INDX";
/// The tiles' planes of the height layer.
pub const TILES: [u8; 4] = *b"TILE";

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// What it is.
    pub kind: [u8; 4],
    /// See [`REQUIRED`].
    pub flags: u32,
    /// First byte in the file.
    pub offset: u64,
    /// Bytes.
    pub length: u64,
    /// BLAKE3 of those bytes.
    pub hash: [u8; 32],
}

impl Section {
    /// The row's bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; ROW_BYTES] {
        let mut bytes = [0; ROW_BYTES];
        bytes[..4].copy_from_slice(&self.kind);
        bytes[4..8].copy_from_slice(&self.flags.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.offset.to_le_bytes());
        bytes[16..24].copy_from_slice(&self.length.to_le_bytes());
        bytes[32..].copy_from_slice(&self.hash);
        bytes
    }

    /// Reads a table whose hash has been checked; every section must lie between `begin` and
    /// `end`, in order and apart.
    pub fn decode_table(bytes: &[u8], begin: u64, end: u64) -> Result<Vec<Self>, FormatError> {
        let mut last = begin;
        let mut table = Vec::with_capacity(bytes.len() / ROW_BYTES);
        for row in bytes.chunks_exact(ROW_BYTES) {
            let section = Self {
                kind: array(row, 0),
                flags: u32::from_le_bytes(array(row, 4)),
                offset: u64::from_le_bytes(array(row, 8)),
                length: u64::from_le_bytes(array(row, 16)),
                hash: array(row, 32),
            };
            let stop = section.offset.checked_add(section.length);
            if section.offset < last || !section.offset.is_multiple_of(ALIGNMENT) || stop.is_none_or(|stop| stop > end)
            {
                return Err(FormatError::damaged("a section lies outside the file or over another"));
            }
            let known = [META, MESH, INDEX, TILES].contains(&section.kind);
            if !known && section.flags & REQUIRED != 0 {
                return Err(FormatError::Unsupported(format!("section {:?}", String::from_utf8_lossy(&section.kind))));
            }
            last = section.offset + section.length;
            table.push(section);
        }
        Ok(table)
    }
}

/// `offset` rounded up to the alignment of sections.
#[must_use]
pub const fn align(offset: u64) -> u64 {
    offset.next_multiple_of(ALIGNMENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROW: Section = Section { kind: META, flags: 0, offset: 512, length: 100, hash: [1; 32] };

    #[test]
    fn round_trip_and_limits() {
        assert_eq!(Section::decode_table(&ROW.encode(), 320, 700).unwrap(), [ROW]);
        for bad in [
            Section { offset: 513, ..ROW },
            Section { offset: 256, ..ROW },
            Section { length: 189, ..ROW },
            Section { length: u64::MAX, ..ROW },
            Section { kind: *b"WHAT", flags: REQUIRED, ..ROW },
        ] {
            assert!(Section::decode_table(&bad.encode(), 320, 700).is_err(), "{bad:?}");
        }
        let later_layer = Section { kind: *b"IMGS", ..ROW };
        assert_eq!(Section::decode_table(&later_layer.encode(), 320, 700).unwrap(), [later_layer]);
    }
}
