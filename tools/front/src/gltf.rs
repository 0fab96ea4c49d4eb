//! The patch mesh with relief as binary glTF 2.0 (.glb).
//!
//! glTF is right-handed with Y up and its front towards +Z. A globe's north is +Y, longitude 0
//! faces +Z and longitude 90 east is +X: (X, Y, Z) = (y, z, x) of ECEF, relative to the centre.
//! A plane has east on +X, north on -Z and height on +Y, relative to the middle of its square.
//! Lengths are metres. Positions are f32, rounded once from f64: each coordinate is at most half
//! a unit in the last place off, which is 0.25 m where it exceeds 4194 km (the Earth), 0.0625 m
//! on the Moon.

mod container;

use std::collections::HashMap;

use relief_formats::body::Body;
use relief_formats::geodesy::{Ellipsoid, T_NORTH, lat_deg, lon_deg};
use relief_formats::mesh::PatchMesh;
use serde_json::{Value, json};

use container::{Parts, container};

/// A mesh that cannot be written as glTF.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GlbError {
    /// The heights have a hole: their owner fills it.
    #[error("height at S {s}, T {t} is {height_m}: must be a finite number of metres")]
    Height {
        /// Fixed-point longitude.
        s: u32,
        /// Fixed-point latitude.
        t: u32,
        /// What was found.
        height_m: f64,
    },
    /// A glb counts its bytes in 32 bits: use a smaller texture.
    #[error("the file would have {0} bytes: a glb has at most 4294967295")]
    TooLarge(usize),
}

/// The bytes of a .glb: one mesh with positions, normals of the relief (area-weighted over the
/// triangles at a place, seam and poles included), texture coordinates (s, 1 - t) and u32 indices.
///
/// `height_m` gives the height at fixed-point (S, T); it is asked once for each vertex. A texture
/// is an equirectangular PNG with north at the top.
///
/// # Errors
/// A height that is not finite, or more bytes than a glb can have.
pub fn glb(
    mesh: &PatchMesh,
    body: &Body,
    name: &str,
    texture_png: Option<&[u8]>,
    mut height_m: impl FnMut(u32, u32) -> f64,
) -> Result<Vec<u8>, GlbError> {
    let middle = if body.is_plane() { mesh.place(body, T_NORTH / 2, T_NORTH / 2) } else { [0.0; 2] };
    let mut positions = Vec::with_capacity(mesh.vertex_count() as usize);
    for vertex in mesh.vertices() {
        let height_m = height_m(vertex.s, vertex.t);
        if !height_m.is_finite() {
            return Err(GlbError::Height { s: vertex.s, t: vertex.t, height_m });
        }
        let [x, y, z] = mesh.position(body, vertex, height_m);
        positions.push(if body.is_plane() { [x - middle[0], z, middle[1] - y] } else { [y, z, x] });
    }
    let normals = normals(mesh, body, &positions);
    let mut parts = Parts::default();
    let attributes = json!({
        "POSITION": parts.accessor(&positions.iter().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>(), "VEC3"),
        "NORMAL": parts.accessor(&normals, "VEC3"),
        "TEXCOORD_0": parts.accessor(
            &mesh.vertices().map(|v| [v.tex[0] as f32, (1.0 - v.tex[1]) as f32]).collect::<Vec<_>>(), "VEC2"),
    });
    let indices = parts.indices(&mesh.indices);
    let mut material = json!({
        "name": "relief",
        "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 },
    });
    let mut document = json!({
        "asset": { "version": "2.0", "generator": concat!("relief-bake ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": name }],
        "meshes": [{ "name": name, "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }] }],
    });
    if let Some(png) = texture_png {
        let view = parts.view(png, None);
        material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
        document["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
        // Repeat across the seam, clamp at the poles, linear with mipmaps.
        document["samplers"] = json!([{ "magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 33071 }]);
        document["textures"] = json!([{ "sampler": 0, "source": 0 }]);
    }
    document["materials"] = json!([material]);
    document["accessors"] = Value::Array(parts.accessors);
    document["bufferViews"] = Value::Array(parts.views);
    document["buffers"] = json!([{ "byteLength": parts.bytes.len() }]);
    container(document.to_string().into_bytes(), parts.bytes)
}

/// Sum of the triangles' area vectors at each place; where that is nothing, the body's normal.
fn normals(mesh: &PatchMesh, body: &Body, positions: &[[f64; 3]]) -> Vec<[f32; 3]> {
    let globe = !body.is_plane();
    // All vertices of a pole are one place, as are both ends of a row.
    let key = |s: u32, t: u32| if globe && (t == 0 || t == T_NORTH) { (0, t) } else { (s, t) };
    let keys: Vec<_> = mesh.vertices().map(|v| key(v.s, v.t)).collect();
    let mut sums: HashMap<(u32, u32), [f64; 3]> = HashMap::with_capacity(keys.len());
    for triangle in mesh.triangles() {
        let [Some(&a), Some(&b), Some(&c)] = triangle.map(|v| positions.get(v as usize)) else { continue };
        let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let area = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for corner in triangle {
            let sum = sums.entry(keys[corner as usize]).or_default();
            *sum = [sum[0] + area[0], sum[1] + area[1], sum[2] + area[2]];
        }
    }
    let at = |&(s, t): &(u32, u32)| {
        let sum = sums.get(&(s, t)).copied().unwrap_or_default();
        let length = sum[0].hypot(sum[1]).hypot(sum[2]);
        if length > 0.0 {
            return sum.map(|x| (x / length) as f32);
        }
        let [x, y, z] = if globe { Ellipsoid::normal_from_deg(lon_deg(s), lat_deg(t)) } else { [0.0, 0.0, 1.0] };
        [y as f32, z as f32, x as f32]
    };
    keys.iter().map(at).collect()
}

#[cfg(test)]
mod tests;
