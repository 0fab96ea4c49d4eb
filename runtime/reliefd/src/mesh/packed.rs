//! A mesh as viewers get it: quantised, relative to the camera.

use relief_protocol::mesh::{VERTEX_BYTES, Vertex};
use relief_protocol::payload::MeshCounts;
use relief_runtime::frame::ReliefTriangle;
use relief_runtime::planet::Planet;
use relief_runtime::view::Camera;

use super::vertices::Vertices;

/// Counts, and the bytes as PROTOCOL.md describes them.
pub fn packed(planet: &Planet, camera: &Camera, triangles: &[ReliefTriangle]) -> (MeshCounts, Vec<u8>) {
    let vertices = Vertices::new(planet, camera, camera.height_m, triangles);
    let normals = vertices.normals();
    let mut bytes = Vec::with_capacity(VERTEX_BYTES * vertices.positions.len() + 4 * vertices.indices.len());
    for ((&[s, t], &position_m), &normal) in vertices.places.iter().zip(&vertices.positions).zip(&normals) {
        let normal = vertices.at_place(normal, [s, t]);
        bytes.extend_from_slice(&Vertex { position_m, s, t, normal }.bytes());
    }
    for index in &vertices.indices {
        bytes.extend_from_slice(&index.to_le_bytes());
    }
    let counts = MeshCounts { vertices: vertices.positions.len() as u32, indices: vertices.indices.len() as u32 };
    (counts, bytes)
}
