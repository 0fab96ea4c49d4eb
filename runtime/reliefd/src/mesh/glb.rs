//! A frame's mesh as binary glTF 2.0.
//!
//! Origin: the foot of the camera, on the ellipsoid (a plane: at height 0). +X is east there, +Y
//! up, +Z south; metres.

use relief_front::error::ToolError;
use relief_runtime::frame::ReliefTriangle;
use relief_runtime::planet::Planet;
use relief_runtime::view::Camera;
use serde_json::json;

use super::vertices::Vertices;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const MOST_BYTES: usize = u32::MAX as usize;

/// The bytes of a .glb; the triangles are put in order, for a GPU yields them in any.
///
/// # Errors
/// No triangle, or more than a .glb can hold.
pub fn glb(planet: &Planet, camera: &Camera, mut triangles: Vec<ReliefTriangle>) -> Result<Vec<u8>, ToolError> {
    triangles.sort_unstable_by_key(|corners| corners.map(|corner| (corner.s, corner.t)));
    if triangles.is_empty() {
        return Err(ToolError::usage(
            "--mesh of a view of the sky",
            "a mesh has triangles",
            "turn the camera to the ground, or leave --mesh out",
        ));
    }
    let vertices = Vertices::new(planet, camera, 0.0, &triangles);
    let normals = vertices.normals();
    let Vertices { positions, indices, .. } = &vertices;
    let (vertex_bytes, index_bytes) = (12 * positions.len(), 4 * indices.len());
    let binary_bytes = 2 * vertex_bytes + index_bytes;
    if binary_bytes > MOST_BYTES - (1 << 16) {
        return Err(ToolError::usage(
            format!("--mesh of {} triangles", triangles.len()),
            "a .glb counts its bytes in 32 bits",
            "give a larger --pixel-error",
        ));
    }
    let bound = |pick: fn(f32, f32) -> f32| {
        positions.iter().copied().reduce(|a, b| std::array::from_fn(|k| pick(a[k], b[k]))).unwrap_or_default()
    };
    let accessor = |view: u32, kind: u32, count: usize, shape: &str| json!({"bufferView": view, "componentType": kind, "count": count, "type": shape});
    let mut position = accessor(0, FLOAT, positions.len(), "VEC3");
    position["min"] = json!(bound(f32::min));
    position["max"] = json!(bound(f32::max));
    let part = |offset: usize, length: usize, target: u32| json!({"buffer": 0, "byteOffset": offset, "byteLength": length, "target": target});
    let document = json!({
        "asset": {"version": "2.0", "generator": "reliefd"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "relief"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
        "accessors": [
            position,
            accessor(1, FLOAT, normals.len(), "VEC3"),
            accessor(2, UNSIGNED_INT, indices.len(), "SCALAR"),
        ],
        "bufferViews": [
            part(0, vertex_bytes, VERTICES),
            part(vertex_bytes, vertex_bytes, VERTICES),
            part(2 * vertex_bytes, index_bytes, INDICES),
        ],
        "buffers": [{"byteLength": binary_bytes}],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = Vec::with_capacity(28 + text.len() + binary_bytes);
    out.extend_from_slice(b"glTF");
    for word in [2, (28 + text.len() + binary_bytes) as u32, text.len() as u32] {
        out.extend_from_slice(&word.to_le_bytes());
    }
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&text);
    out.extend_from_slice(&(binary_bytes as u32).to_le_bytes());
    out.extend_from_slice(b"BIN\0");
    for value in positions.iter().chain(&normals).flatten() {
        out.extend_from_slice(&value.to_le_bytes());
    }
    for index in indices {
        out.extend_from_slice(&index.to_le_bytes());
    }
    Ok(out)
}
