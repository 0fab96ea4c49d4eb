//! What must hold of any bytes: no panic, no allocation that they do not pay for, and what was read
//! once reads the same again.

use relief_protocol::MOST_MESSAGE_BYTES;
use relief_protocol::mesh::{VERTEX_BYTES, unpack};
use relief_protocol::payload::Header;
use relief_protocol::to_server::ToServer;
use relief_protocol::to_viewer::ToViewer;

/// A message of a viewer, or of the daemon.
pub fn to_server(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match ToServer::parse(text) {
        Ok(message) => {
            assert!(text.len() <= MOST_MESSAGE_BYTES);
            let again = message.text();
            // Written out, a message may be a little longer than it came.
            if again.len() <= MOST_MESSAGE_BYTES {
                assert_eq!(ToServer::parse(&again).as_ref(), Ok(&message), "{again}");
            }
        }
        Err(fault) => assert!(!fault.what.is_empty() && !fault.rule.is_empty() && !fault.remedy.is_empty()),
    }
    if let Ok(message) = ToViewer::parse(text) {
        assert_eq!(ToViewer::parse(&message.text()).ok(), Some(message));
    }
}

/// The header of a payload.
pub fn envelope(data: &[u8]) {
    if let Ok((header, payload)) = Header::open(data) {
        let mut again = header.envelope();
        assert_eq!(again.len() % 8, 0);
        again.extend_from_slice(payload);
        assert_eq!(Header::open(&again), Ok((header, payload)));
    }
}

/// A mesh: its counts, then its payload.
pub fn mesh(data: &[u8]) {
    let Some((counts, payload)) = data.split_first_chunk::<8>() else { return };
    let [a, b, c, d, e, f, g, h] = *counts;
    let (vertices, indices) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
    if let Ok((corners, triangles)) = unpack(payload, vertices, indices) {
        assert_eq!(payload.len(), corners.len() * VERTEX_BYTES + 4 * triangles.len());
        assert!(triangles.iter().all(|&corner| (corner as usize) < corners.len()));
        for corner in corners {
            // Mantissas are kept, whatever they are.
            let again = relief_protocol::mesh::Vertex::of(&corner.bytes());
            assert_eq!((corner.s, corner.t), (again.s, again.t));
        }
    }
}
