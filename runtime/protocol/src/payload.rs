//! Payloads: pictures, masks, depths and meshes with a header in JSON before them.
//!
//! An envelope is the header's length (u32, little-endian), the header, spaces up to a multiple of
//! eight bytes, and the payload.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Multiple of bytes at which a payload begins.
const ALIGNED: usize = 8;
/// Most bytes of a header.
const MOST_HEADER_BYTES: usize = 64 << 10;

/// What a payload is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// The stream it belongs to.
    pub stream: Stream,
    /// How it is packed.
    pub format: Format,
    /// The camera.
    pub camera: String,
    /// The viewer's number of the view that it shows.
    pub view: u64,
    /// Grows with every picture of a camera; the payloads of one picture have the same.
    pub seq: u64,
    /// This payload among those of the picture, from 0.
    pub part: u32,
    /// Payloads of the picture.
    pub parts: u32,
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// False while tiles are still to come: a better picture of the same view follows.
    pub complete: bool,
    /// The sub-solar point, degrees (a plane: azimuth and elevation).
    pub sun: [f64; 2],
    /// What the picture cost.
    pub stats: Stats,
    /// Of a mesh only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshCounts>,
}

/// Streams of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stream {
    /// The picture.
    Frame,
    /// The visible part of the sun.
    Mask,
    /// Distances.
    Depth,
    /// Triangles.
    Mesh,
}

/// How a payload is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// JPEG.
    Jpeg,
    /// PNG.
    Png,
    /// RGBA, four bytes a pixel.
    Rgba,
    /// A byte a pixel.
    U8,
    /// f32, little-endian.
    F32,
    /// [`crate::mesh`].
    Mesh,
}

/// What a picture cost.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Stats {
    /// Triangles drawn.
    pub triangles: u64,
    /// Pages in the atlas.
    pub tiles_resident: u64,
    /// Pages that the picture lacks.
    pub tiles_missing: u64,
    /// Milliseconds from the start of drawing to the picture in memory.
    pub draw_ms: f64,
    /// Milliseconds from the view's arrival to the start of drawing.
    pub wait_ms: f64,
    /// Milliseconds of each pass.
    pub pass_ms: BTreeMap<String, f64>,
    /// Samples that a shadow ray fetched on the mean; none without shadows.
    pub fetches_per_ray: Option<f64>,
    /// True when the mesh has holes: too many triangles.
    pub holes: bool,
}

/// Sizes of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshCounts {
    /// Vertices, [`crate::mesh::VERTEX_BYTES`] each.
    pub vertices: u32,
    /// Indices, four bytes each, three for a triangle, after the vertices.
    pub indices: u32,
}

/// An envelope that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EnvelopeError {
    /// It ends too early.
    #[error("an envelope of {bytes} bytes, where its header alone needs {needed}")]
    Short {
        /// Bytes there are.
        bytes: usize,
        /// Bytes the header needs.
        needed: usize,
    },
    /// A header longer than any.
    #[error("a header of {0} bytes: must be at most 65536")]
    Long(usize),
    /// A header that is no JSON of this version.
    #[error("a header that cannot be read: {0}")]
    Header(String),
}

impl Header {
    /// The bytes before a payload.
    #[must_use]
    pub fn envelope(&self) -> Vec<u8> {
        // Numbers that are not finite become null; nothing else can fail.
        let mut text = serde_json::to_vec(self).unwrap_or_default();
        text.resize((4 + text.len()).next_multiple_of(ALIGNED) - 4, b' ');
        let mut out = Vec::with_capacity(4 + text.len());
        out.extend_from_slice(&(text.len() as u32).to_le_bytes());
        out.extend_from_slice(&text);
        out
    }

    /// The header of an envelope, and the payload after it.
    ///
    /// # Errors
    /// [`EnvelopeError`] for what no daemon of this version sends.
    pub fn open(envelope: &[u8]) -> Result<(Self, &[u8]), EnvelopeError> {
        let short = |needed| EnvelopeError::Short { bytes: envelope.len(), needed };
        let (length, rest) = envelope.split_first_chunk::<4>().ok_or(short(4))?;
        let length = u32::from_le_bytes(*length) as usize;
        if length > MOST_HEADER_BYTES {
            return Err(EnvelopeError::Long(length));
        }
        let (text, payload) = rest.split_at_checked(length).ok_or(short(4 + length))?;
        let header = serde_json::from_slice(text).map_err(|error| EnvelopeError::Header(error.to_string()))?;
        Ok((header, payload))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn header(camera: &str) -> Header {
        Header {
            stream: Stream::Depth,
            format: Format::F32,
            camera: camera.into(),
            view: 4,
            seq: 5,
            part: 1,
            parts: 2,
            size: [3, 2],
            complete: true,
            sun: [10.0, -20.5],
            stats: Stats::default(),
            mesh: None,
        }
    }

    #[test]
    fn envelopes_open() {
        for camera in ["a", "ab", "abc", "abcdefgh", "Kaméra"] {
            let mut bytes = header(camera).envelope();
            assert_eq!(bytes.len() % 8, 0);
            bytes.extend_from_slice(b"payload");
            assert_eq!(Header::open(&bytes), Ok((header(camera), &b"payload"[..])));
        }
    }

    #[test]
    fn broken_envelopes_are_refused() {
        let bytes = header("a").envelope();
        for cut in 0..bytes.len() {
            assert!(matches!(Header::open(&bytes[..cut]), Err(EnvelopeError::Short { .. })), "{cut}");
        }
        assert_eq!(Header::open(&[255; 8]), Err(EnvelopeError::Long(u32::MAX as usize)));
        assert!(matches!(Header::open(b"\x02\0\0\0{}"), Err(EnvelopeError::Header(_))));
    }

    proptest! {
        #[test]
        fn no_bytes_end_in_a_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            let _ = Header::open(&bytes);
        }
    }
}
