//! Meshes as bytes: vertices of 20 bytes, then indices (u32), all little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 0 | i16 x 3: mantissas of the position, east, up and south of the camera, metres |
//! | 6 | i16: their exponent e: a coordinate is mantissa x 2^e |
//! | 8 | u32 x 2: S and T of the texture, fixed point (S: 2^32 a turn, T: 2^31 from pole to pole; a plane: 2^31 a side) |
//! | 16 | i16 x 2: east and north of the relief's unit normal at the vertex, times 32767; up is positive |
//!
//! A coordinate is off by at most 2^-15 of the largest of the three, so by less than 1/30 pixel in a
//! picture 1080 pixels high with 60 degrees of field. Corners that triangles share are one vertex.

/// Bytes of a vertex.
pub const VERTEX_BYTES: usize = 20;

/// A corner of triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// East, up and south of the camera, metres.
    pub position_m: [f32; 3],
    /// Fixed point.
    pub s: u32,
    /// Fixed point.
    pub t: u32,
    /// East and north of the unit normal there.
    pub normal: [f32; 2],
}

impl Vertex {
    /// As bytes; a position that is not finite, or larger than any planet, becomes the origin.
    #[must_use]
    pub fn bytes(&self) -> [u8; VERTEX_BYTES] {
        let (mantissas, exponent) = quantised(self.position_m);
        let [a, b] = self.normal.map(|v| (v.clamp(-1.0, 1.0) * 32767.0).round() as i16);
        let mut out = [0; VERTEX_BYTES];
        let [x, y, z] = mantissas;
        for (k, word) in [x, y, z, exponent].into_iter().enumerate() {
            out[2 * k..2 * k + 2].copy_from_slice(&word.to_le_bytes());
        }
        out[8..12].copy_from_slice(&self.s.to_le_bytes());
        out[12..16].copy_from_slice(&self.t.to_le_bytes());
        out[16..18].copy_from_slice(&a.to_le_bytes());
        out[18..20].copy_from_slice(&b.to_le_bytes());
        out
    }

    /// From bytes.
    #[must_use]
    pub fn of(bytes: &[u8; VERTEX_BYTES]) -> Self {
        let short = |at: usize| i16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let long = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let scale = 2f64.powi(i32::from(short(6)));
        Self {
            position_m: [0, 2, 4].map(|at| (f64::from(short(at)) * scale) as f32),
            s: long(8),
            t: long(12),
            normal: [16, 18].map(|at| f32::from(short(at)) / 32767.0),
        }
    }
}

/// Mantissas of at most 32767 and their common exponent.
fn quantised(position_m: [f32; 3]) -> ([i16; 3], i16) {
    let largest = position_m.iter().fold(0f32, |most, v| most.max(v.abs()));
    if !(largest > 0.0 && largest.is_finite()) || position_m.iter().any(|v| v.is_nan()) {
        return ([0; 3], 0);
    }
    let mut exponent = f64::from(largest).log2().floor() as i32 - 14;
    // The largest may round up to 2^15.
    if (f64::from(largest) * 2f64.powi(-exponent)).round() > 32767.0 {
        exponent += 1;
    }
    let scale = 2f64.powi(-exponent);
    (position_m.map(|v| (f64::from(v) * scale).round() as i16), exponent as i16)
}

/// Vertices and indices of a payload.
///
/// # Errors
/// Says what does not fit: counts and bytes, or an index without a vertex.
pub fn unpack(payload: &[u8], vertices: u32, indices: u32) -> Result<(Vec<Vertex>, Vec<u32>), String> {
    let needed = u64::from(vertices) * VERTEX_BYTES as u64 + 4 * u64::from(indices);
    if payload.len() as u64 != needed {
        return Err(format!("a mesh of {} bytes: its counts need {needed}", payload.len()));
    }
    let (head, tail) = payload.split_at(vertices as usize * VERTEX_BYTES);
    let corners = head.as_chunks::<VERTEX_BYTES>().0.iter().map(Vertex::of).collect();
    let indices: Vec<u32> = tail.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
    match indices.iter().find(|&&index| index >= vertices) {
        Some(index) => Err(format!("an index of {index} among {vertices} vertices")),
        None => Ok((corners, indices)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_position_is_kept_within_its_bound(x in -1e9f32..1e9, y in -1e9f32..1e9, z in -1e9f32..1e9, shrink in -40i32..1) {
            let position_m = [x, y, z].map(|v| v * 2f32.powi(shrink));
            let vertex = Vertex { position_m, s: 7, t: u32::MAX, normal: [0.25, -0.5] };
            let back = Vertex::of(&vertex.bytes());
            let largest = position_m.iter().fold(0f32, |most, v| most.max(v.abs()));
            for (a, b) in position_m.into_iter().zip(back.position_m) {
                prop_assert!((f64::from(a) - f64::from(b)).abs() <= f64::from(largest) / 32768.0);
            }
            prop_assert_eq!((back.s, back.t), (7, u32::MAX));
            prop_assert!((back.normal[0] - 0.25).abs() < 4e-5 && (back.normal[1] + 0.5).abs() < 4e-5);
        }
    }

    #[test]
    fn meshes_that_do_not_fit_are_refused() {
        let vertex = Vertex { position_m: [1.0, 2.0, 3.0], s: 0, t: 0, normal: [0.0; 2] };
        let mut payload = vertex.bytes().to_vec();
        payload.extend_from_slice(&0u32.to_le_bytes());
        assert!(unpack(&payload, 1, 1).is_ok());
        assert!(unpack(&payload, 1, 2).is_err() && unpack(&payload, u32::MAX, u32::MAX).is_err());
        payload[20] = 1;
        assert!(unpack(&payload, 1, 1).unwrap_err().contains("index of 1"));
    }

    #[test]
    fn what_is_no_place_becomes_the_origin() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(quantised([1.0, bad, 0.0]), ([0; 3], 0));
        }
    }
}
