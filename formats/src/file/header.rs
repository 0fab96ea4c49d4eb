//! The fixed 256-byte header (SPEC, "Header").

use super::FormatError;
use crate::body::Body;
use crate::codec::nodes::SAMPLE_LIMIT;
use crate::grid::{Grid, M_RANGE};

/// First bytes of every file. The high bit and the line ends show transfers that changed bytes.
pub const MAGIC: [u8; 8] = *b"\x89RLF\r\n\x1a\n";
/// Bytes of the header.
pub const HEADER_BYTES: usize = 256;
/// Major version: a reader refuses any other.
pub const MAJOR: u16 = 1;
/// Minor version: newer ones add what older readers may ignore.
pub const MINOR: u16 = 0;
/// Where the header's own BLAKE3 lies, over all bytes before it.
pub(super) const HASH_AT: usize = 224;
/// What a newer minor version may use: its number, optional features, reserved bytes.
const OPEN_TO_LATER: [std::ops::Range<usize>; 4] = [10..12, 24..32, 100..104, 200..HASH_AT];
/// Exponents k that a step of 2^k metres may have.
pub const STEP_EXPONENTS: std::ops::RangeInclusive<i8> = -16..=10;

/// The header's numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// What the heights stand on. The CRS text of a plane lives in the metadata.
    pub body: Body,
    /// The map exponent.
    pub m: u32,
    /// Heights are q 2^`step_exponent` metres.
    pub step_exponent: i8,
    /// Height of the South Pole in steps (a plane: of node (0, 0)).
    pub south_pole_q: i32,
    /// Height of the North Pole in steps (a plane: of its last node).
    pub north_pole_q: i32,
    /// Smallest height over all stored nodes, in steps.
    pub min_q: i32,
    /// Largest height over all stored nodes, in steps.
    pub max_q: i32,
    /// Number of tiles in the index.
    pub tile_count: u64,
    /// Bytes of the whole file, tail included.
    pub file_bytes: u64,
    /// Identity: a hash tree over decoded tiles.
    pub content_id: [u8; 32],
    /// Number of sections.
    pub section_count: u32,
    /// BLAKE3 of the section table.
    pub table_hash: [u8; 32],
}

impl Header {
    /// The grid of nodes.
    #[must_use]
    pub fn grid(&self) -> Grid {
        Grid::new(self.m, self.body.is_plane())
    }

    /// Metres per step.
    #[must_use]
    pub fn step_m(&self) -> f64 {
        f64::from(self.step_exponent).exp2()
    }

    /// The bytes that identify what the heights mean; part of [`Header::content_id`].
    #[must_use]
    pub fn identity_bytes(&self) -> Vec<u8> {
        self.encode()[32..72].iter().chain(&self.encode()[136..168]).copied().collect()
    }

    /// The 256 bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
        put(0, &MAGIC);
        put(8, &MAJOR.to_le_bytes());
        put(10, &MINOR.to_le_bytes());
        put(12, &(HEADER_BYTES as u32).to_le_bytes());
        put(32, &[u8::from(self.body.is_plane()), self.m as u8, self.grid().root_level() as u8]);
        put(35, &self.step_exponent.to_le_bytes());
        match &self.body {
            Body::Ellipsoid { a_m, b_m, .. } => {
                put(40, &a_m.to_le_bytes());
                put(48, &b_m.to_le_bytes());
            }
            Body::Plane { x0, y0, dx, dy, .. } => {
                for (at, value) in [(136, x0), (144, y0), (152, dx), (160, dy)] {
                    put(at, &value.to_le_bytes());
                }
            }
        }
        put(56, &self.south_pole_q.to_le_bytes());
        put(60, &self.north_pole_q.to_le_bytes());
        put(64, &self.min_q.to_le_bytes());
        put(68, &self.max_q.to_le_bytes());
        put(72, &self.tile_count.to_le_bytes());
        put(80, &self.file_bytes.to_le_bytes());
        put(88, &(HEADER_BYTES as u64).to_le_bytes());
        put(96, &self.section_count.to_le_bytes());
        put(104, &self.content_id);
        put(168, &self.table_hash);
        let hash = *blake3::hash(&bytes[..HASH_AT]).as_bytes();
        bytes[HASH_AT..].copy_from_slice(&hash);
        bytes
    }

    /// True when `bytes`, whose hash is right, hold nothing but what [`Header::encode`] writes and
    /// what a newer minor version may add.
    fn explains(&self, bytes: &[u8]) -> bool {
        let mut known = self.encode();
        if bytes[10..12] != MINOR.to_le_bytes() {
            OPEN_TO_LATER.into_iter().for_each(|open| known[open.clone()].copy_from_slice(&bytes[open]));
        }
        known[..HASH_AT] == bytes[..HASH_AT]
    }

    /// Reads and checks a header. The ellipsoid's name and a plane's CRS are empty: they are in
    /// the metadata.
    pub fn decode(bytes: &[u8]) -> Result<Self, FormatError> {
        if bytes.len() < HEADER_BYTES {
            return Err(FormatError::NotRelief("shorter than a header"));
        }
        let bytes = &bytes[..HEADER_BYTES];
        if bytes[..8] != MAGIC {
            return Err(FormatError::NotRelief("the first eight bytes are not its signature"));
        }
        let major = u16::from_le_bytes([bytes[8], bytes[9]]);
        if major != MAJOR {
            return Err(FormatError::Unsupported(format!("major version {major}, this reader knows {MAJOR}")));
        }
        if blake3::hash(&bytes[..HASH_AT]).as_bytes()[..] != bytes[HASH_AT..] {
            return Err(FormatError::damaged("the header's checksum does not match"));
        }
        let u64_at = |at: usize| u64::from_le_bytes(array(bytes, at));
        let i32_at = |at: usize| i32::from_le_bytes(array(bytes, at));
        let f64_at = |at: usize| f64::from_le_bytes(array(bytes, at));
        if u64_at(16) != 0 {
            return Err(FormatError::Unsupported(format!("required features {:#x}", u64_at(16))));
        }
        let m = u32::from(bytes[33]);
        let body = match bytes[32] {
            0 => Body::Ellipsoid { name: String::new(), a_m: f64_at(40), b_m: f64_at(48) },
            1 => Body::Plane {
                crs_wkt: String::new(),
                x0: f64_at(136),
                y0: f64_at(144),
                dx: f64_at(152),
                dy: f64_at(160),
            },
            kind => return Err(FormatError::Unsupported(format!("body kind {kind}"))),
        };
        let sizes_good = match &body {
            Body::Ellipsoid { a_m, b_m, .. } => [a_m, b_m].iter().all(|&&v| v.is_finite() && v > 0.0),
            Body::Plane { x0, y0, dx, dy, .. } => {
                [x0, y0, dx, dy].iter().all(|v| v.is_finite()) && *dx > 0.0 && *dy > 0.0
            }
        };
        let header = Self {
            body,
            m,
            step_exponent: bytes[35] as i8,
            south_pole_q: i32_at(56),
            north_pole_q: i32_at(60),
            min_q: i32_at(64),
            max_q: i32_at(68),
            tile_count: u64_at(72),
            file_bytes: u64_at(80),
            content_id: array(bytes, 104),
            section_count: u32::from_le_bytes(array(bytes, 96)),
            table_hash: array(bytes, 168),
        };
        let samples = [header.south_pole_q, header.north_pole_q, header.min_q, header.max_q];
        if !M_RANGE.contains(&m)
            || !sizes_good
            || !STEP_EXPONENTS.contains(&header.step_exponent)
            || samples.iter().any(|q| q.unsigned_abs() > SAMPLE_LIMIT.unsigned_abs())
            || header.min_q > header.max_q
            || !header.explains(bytes)
        {
            return Err(FormatError::damaged("the header holds a number out of range"));
        }
        Ok(header)
    }
}

/// A fixed-size piece of a slice that is known to be long enough.
pub(super) fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&bytes[at..at + N]);
    out
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn sample() -> Header {
        Header {
            body: Body::Ellipsoid { name: String::new(), a_m: 6_378_137.0, b_m: 6_356_752.0 },
            m: 11,
            step_exponent: -4,
            south_pole_q: 2835,
            north_pole_q: -4228,
            min_q: -10_000,
            max_q: 9000,
            tile_count: 170,
            file_bytes: 12_345_678,
            content_id: [7; 32],
            section_count: 4,
            table_hash: [9; 32],
        }
    }

    #[test]
    fn round_trip() {
        let header = sample();
        assert_eq!(Header::decode(&header.encode()).unwrap(), header);
        let plane =
            Header { body: Body::Plane { crs_wkt: String::new(), x0: -3.5, y0: 1e6, dx: 30.0, dy: 30.0 }, ..sample() };
        assert_eq!(Header::decode(&plane.encode()).unwrap(), plane);
    }

    #[test]
    fn every_flipped_bit_is_refused() {
        let bytes = sample().encode();
        for bit in 0..HEADER_BYTES * 8 {
            let mut bad = bytes;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(Header::decode(&bad).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn newer_minor_versions_are_read_and_other_changes_are_not() {
        let changed = |changes: &[(usize, u8)]| {
            let mut bytes = sample().encode();
            changes.iter().for_each(|&(at, value)| bytes[at] = value);
            let hash = *blake3::hash(&bytes[..HASH_AT]).as_bytes();
            bytes[HASH_AT..].copy_from_slice(&hash);
            Header::decode(&bytes)
        };
        assert_eq!(changed(&[(10, 1)]).unwrap(), sample());
        assert_eq!(changed(&[(10, 1), (24, 1), (100, 5), (223, 7)]).unwrap(), sample());
        for damaged in [vec![(24, 1)], vec![(100, 5)], vec![(223, 7)], vec![(10, 1), (36, 1)], vec![(10, 1), (136, 1)]]
        {
            assert!(matches!(changed(&damaged), Err(FormatError::Damaged(_))), "{damaged:?}");
        }
        for newer in [[(8, 2)], [(16, 1)], [(32, 2)]] {
            assert!(matches!(changed(&newer), Err(FormatError::Unsupported(_))), "{newer:?}");
        }
    }

    #[test]
    fn values_out_of_range_are_refused_even_when_signed() {
        for bad in [
            Header { m: 7, ..sample() },
            Header { m: 21, ..sample() },
            Header { step_exponent: 11, ..sample() },
            Header { min_q: 1, max_q: 0, ..sample() },
            Header { body: Body::Ellipsoid { name: String::new(), a_m: f64::NAN, b_m: 1.0 }, ..sample() },
        ] {
            assert!(Header::decode(&bad.encode()).is_err(), "{bad:?}");
        }
    }
}
