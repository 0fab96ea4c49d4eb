//! A frame's mesh as binary glTF 2.0.
//!
//! Origin: the foot of the camera, on the ellipsoid (a plane: at height 0). +X is east there, +Y
//! up, +Z south; metres. Positions are f32, rounded once from f64: near the camera they are as
//! exact as the file. Equal corners are one vertex.

use std::collections::HashMap;

use relief_formats::geodesy::{lat_deg, lon_deg, sin_cos_deg};
use relief_front::error::ToolError;
use relief_runtime::planet::Planet;
use relief_runtime::view::Camera;
use relief_shaders::leb::{Corner, ReliefTriangle};
use serde_json::json;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const MOST_BYTES: usize = u32::MAX as usize;

/// The bytes of a .glb.
///
/// # Errors
/// No triangle, or more than a .glb can hold.
pub fn glb(planet: &Planet, camera: &Camera, triangles: &[ReliefTriangle]) -> Result<Vec<u8>, ToolError> {
    if triangles.is_empty() {
        return Err(ToolError::usage(
            "--mesh of a view of the sky",
            "a mesh has triangles",
            "turn the camera to the ground, or leave --mesh out",
        ));
    }
    let place = Place::new(planet, camera);
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut indices: Vec<u32> = Vec::with_capacity(3 * triangles.len());
    for corner in triangles.iter().flatten() {
        let index = *known.entry([corner.s, corner.t, corner.height_m.to_bits()]).or_insert_with(|| {
            positions.push(place.of(corner));
            positions.len() as u32 - 1
        });
        indices.push(index);
    }
    let normals = normals(&positions, &indices);
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
    for index in &indices {
        out.extend_from_slice(&index.to_le_bytes());
    }
    Ok(out)
}

/// Corners in the frame of the camera's foot.
struct Place<'a> {
    planet: &'a Planet,
    camera: &'a Camera,
    origin_m: [f64; 3],
    /// East, up and south in ECEF.
    axes: [[f64; 3]; 3],
}

impl<'a> Place<'a> {
    fn new(planet: &'a Planet, camera: &'a Camera) -> Self {
        let origin_m = planet.ellipsoid().map_or([0.0; 3], |e| e.ecef_from_fixed_m(camera.s, camera.t, 0.0));
        let ((sin_lon, cos_lon), (sin_lat, cos_lat)) = (sin_cos_deg(lon_deg(camera.s)), sin_cos_deg(lat_deg(camera.t)));
        let east = [-sin_lon, cos_lon, 0.0];
        let up = [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat];
        let south = [sin_lat * cos_lon, sin_lat * sin_lon, -cos_lat];
        Self { planet, camera, origin_m, axes: [east, up, south] }
    }

    fn of(&self, corner: &Corner) -> [f32; 3] {
        let height_m = f64::from(corner.height_m);
        let Some(ellipsoid) = self.planet.ellipsoid() else {
            let metres = |v: u32, origin: u32, unit_m: f32| (f64::from(v) - f64::from(origin)) * f64::from(unit_m);
            let uniform = self.planet.uniform();
            let x = metres(corner.s, self.camera.s, uniform.unit_x_m);
            let y = metres(corner.t, self.camera.t, uniform.unit_y_m);
            return [x as f32, height_m as f32, -y as f32];
        };
        let point_m = ellipsoid.ecef_from_fixed_m(corner.s, corner.t, height_m);
        self.axes.map(|axis| (0..3).map(|k| axis[k] * (point_m[k] - self.origin_m[k])).sum::<f64>() as f32)
    }
}

/// Normals of the relief at the vertices: the mean over their triangles, by area.
fn normals(positions: &[[f32; 3]], indices: &[u32]) -> Vec<[f32; 3]> {
    let mut sums = vec![[0f64; 3]; positions.len()];
    for triangle in indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|k| positions[triangle[k] as usize].map(f64::from));
        let (u, v): ([f64; 3], [f64; 3]) = (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for &index in triangle {
            let sum = &mut sums[index as usize];
            *sum = std::array::from_fn(|k| sum[k] + cross[k]);
        }
    }
    let unit = |v: [f64; 3]| {
        let length = v[0].hypot(v[1]).hypot(v[2]);
        // A vertex of slivers only has no normal of its own.
        if length > 0.0 { v.map(|x| (x / length) as f32) } else { [0.0, 1.0, 0.0] }
    };
    sums.into_iter().map(unit).collect()
}
