//! The patch mesh with relief as binary glTF 2.0 (.glb).
//!
//! glTF is right-handed with Y up and its front towards +Z. A globe's north is +Y, longitude 0
//! faces +Z and longitude 90 east is +X: (X, Y, Z) = (y, z, x) of ECEF, relative to the centre.
//! A plane has east on +X, north on -Z and height on +Y, relative to the middle of its square.
//! Lengths are metres. Positions are f32, rounded once from f64: each coordinate is at most half
//! a unit in the last place off, which is 0.25 m where it exceeds 4194 km (the Earth), 0.0625 m
//! on the Moon.

use std::collections::HashMap;

use relief_formats::body::Body;
use relief_formats::geodesy::{Ellipsoid, T_NORTH, lat_deg, lon_deg};
use relief_formats::mesh::PatchMesh;
use serde_json::{Value, json};

/// Bytes of the file's header and of each chunk's.
const FILE_HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const MAGIC: &[u8; 4] = b"glTF";
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

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

/// The binary buffer and what describes it.
#[derive(Default)]
struct Parts {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Parts {
    /// Appends bytes on a 4-byte boundary as a buffer view; returns its number.
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor<const N: usize>(&mut self, values: &[[f32; N]], kind: &str) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let fold = |pick: fn(f32, f32) -> f32, start: f32| {
            let folded = values.iter().fold([start; N], |a, b| std::array::from_fn(|k| pick(a[k], b[k])));
            folded.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>() // exact as decimal text
        };
        let view = self.view(&bytes, Some(34962));
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind,
            "min": fold(f32::min, f32::INFINITY), "max": fold(f32::max, f32::NEG_INFINITY),
        }));
        self.accessors.len() - 1
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(34963));
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR",
            "min": [indices.iter().min()], "max": [indices.iter().max()],
        }));
        self.accessors.len() - 1
    }
}

/// Header, JSON chunk padded with spaces, binary chunk padded with zeros.
fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Result<Vec<u8>, GlbError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = FILE_HEADER + 2 * CHUNK_HEADER + json.len() + binary.len();
    let length = u32::try_from(total).map_err(|_| GlbError::TooLarge(total))?;
    let mut file = Vec::with_capacity(total);
    file.extend(MAGIC);
    file.extend(2u32.to_le_bytes());
    file.extend(length.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use relief_formats::grid::Grid;
    use relief_formats::mesh::{MeshLayout, patch_mesh};

    /// Reads a glb back by the rules of the specification; panics where it breaks one.
    struct Parsed {
        json: Value,
        binary: Vec<u8>,
    }

    impl Parsed {
        fn new(file: &[u8]) -> Self {
            let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap());
            assert_eq!((&file[..4], word(4), word(8) as usize), (&b"glTF"[..], 2, file.len()));
            let json_length = word(12) as usize;
            assert_eq!((&file[16..20], json_length % 4), (&b"JSON"[..], 0));
            let at = 20 + json_length;
            assert_eq!((&file[at + 4..at + 8], word(at) % 4), (&b"BIN\0"[..], 0));
            assert_eq!(at + 8 + word(at) as usize, file.len());
            let parsed = Self { json: serde_json::from_slice(&file[20..at]).unwrap(), binary: file[at + 8..].to_vec() };
            let length = parsed.json["buffers"][0]["byteLength"].as_u64().unwrap() as usize;
            assert!(length <= parsed.binary.len() && parsed.binary.len() - length < 4);
            parsed
        }

        fn view(&self, number: &Value) -> &[u8] {
            let view = &self.json["bufferViews"][number.as_u64().unwrap() as usize];
            let offset = view["byteOffset"].as_u64().unwrap() as usize;
            assert_eq!(offset % 4, 0);
            &self.binary[offset..offset + view["byteLength"].as_u64().unwrap() as usize]
        }

        fn floats<const N: usize>(&self, attribute: &str) -> Vec<[f32; N]> {
            let number = self.json["meshes"][0]["primitives"][0]["attributes"][attribute].as_u64().unwrap();
            let accessor = &self.json["accessors"][number as usize];
            assert_eq!(
                (accessor["componentType"].as_u64(), accessor["type"].as_str().unwrap()),
                (Some(5126), &*format!("VEC{N}"))
            );
            let words = self.view(&accessor["bufferView"]).as_chunks().0.iter().map(|&b| f32::from_le_bytes(b));
            let values: Vec<[f32; N]> = words.collect::<Vec<_>>().as_chunks().0.to_vec();
            assert_eq!(values.len() as u64, accessor["count"].as_u64().unwrap());
            for k in 0..N {
                // serde_json reads an f64 to within one unit in the last place.
                let bound = |name: &str| accessor[name][k].as_f64().unwrap() as f32;
                assert_eq!(bound("min"), values.iter().map(|v| v[k]).fold(f32::INFINITY, f32::min));
                assert_eq!(bound("max"), values.iter().map(|v| v[k]).fold(f32::NEG_INFINITY, f32::max));
            }
            values
        }

        fn indices(&self) -> Vec<u32> {
            let number = self.json["meshes"][0]["primitives"][0]["indices"].as_u64().unwrap();
            let accessor = &self.json["accessors"][number as usize];
            assert_eq!(accessor["componentType"], 5125);
            self.view(&accessor["bufferView"]).as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect()
        }
    }

    fn hills(s: u32, t: u32) -> f64 {
        f64::from(s >> 20) * 3.0 - f64::from(t >> 20)
    }

    #[test]
    fn a_globe_comes_back() {
        let body = Body::earth();
        let mesh = patch_mesh(&body, &Grid::new(10, false), MeshLayout::Aligned);
        let parsed = Parsed::new(&glb(&mesh, &body, "earth", None, hills).unwrap());
        assert_eq!(parsed.indices(), mesh.indices);
        let (positions, tex) = (parsed.floats::<3>("POSITION"), parsed.floats::<2>("TEXCOORD_0"));
        for ((vertex, p), uv) in mesh.vertices().zip(&positions).zip(&tex) {
            let [x, y, z] = mesh.position(&body, vertex, hills(vertex.s, vertex.t));
            for (exact, stored) in [y, z, x].into_iter().zip(p) {
                assert!((exact - f64::from(*stored)).abs() <= 0.25);
            }
            assert_eq!(uv.map(f64::from), [vertex.tex[0], 1.0 - vertex.tex[1]]);
        }
        let outwards = parsed.floats::<3>("NORMAL").iter().zip(&positions).all(|(n, p)| {
            let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
            (length - 1.0).abs() < 1e-6 && n.iter().zip(p).map(|(n, p)| n * p).sum::<f32>() > 0.98 * 6.35e6
        });
        assert!(outwards);
        assert!(parsed.json["asset"]["generator"].as_str().unwrap().starts_with("relief-bake"));
    }

    #[test]
    fn north_is_up_and_longitude_0_in_front() {
        let mesh = patch_mesh(&Body::moon(), &Grid::new(8, false), MeshLayout::Aligned);
        let parsed = Parsed::new(&glb(&mesh, &Body::moon(), "moon", None, |_, _| 100.0).unwrap());
        let positions = parsed.floats::<3>("POSITION");
        // 9 columns of vertices, row 2 is the equator, column 4 longitude 0, column 6 90 east.
        assert_eq!(positions[2 * 9 + 4], [0.0, 0.0, 1_737_500.0]);
        assert_eq!(positions[2 * 9 + 6], [1_737_500.0, 0.0, 0.0]);
        assert_eq!(positions[4 * 9], [0.0, 1_737_500.0, 0.0]);
        let normals = parsed.floats::<3>("NORMAL");
        assert_eq!(normals[9], normals[17], "one normal on both sides of the seam");
        assert!((normals[4 * 9][1] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_plane_is_centred_with_north_away() {
        let body = Body::Plane { crs_wkt: String::new(), x0: 5e5, y0: 4e6, dx: 2.0, dy: 1.0 };
        let mesh = patch_mesh(&body, &Grid::new(8, true), MeshLayout::Aligned);
        let parsed = Parsed::new(&glb(&mesh, &body, "plane", None, |_, _| 3.5).unwrap());
        assert_eq!(parsed.floats::<3>("POSITION")[0], [-256.0, 3.5, 128.0]);
        assert_eq!(parsed.floats::<3>("POSITION")[24], [256.0, 3.5, -128.0]);
        assert!(parsed.floats::<3>("NORMAL").iter().all(|&n| n == [0.0, 1.0, 0.0]));
    }

    #[test]
    fn a_texture_is_embedded_as_it_is() {
        let body = Body::mars();
        let mesh = patch_mesh(&body, &Grid::new(8, false), MeshLayout::Paper);
        let png = b"\x89PNG and so on";
        let parsed = Parsed::new(&glb(&mesh, &body, "a \"quoted\" name", Some(png), hills).unwrap());
        assert_eq!(parsed.view(&parsed.json["images"][0]["bufferView"]), png);
        assert_eq!(parsed.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
        assert_eq!(parsed.json["nodes"][0]["name"], "a \"quoted\" name");
    }

    #[test]
    fn a_hole_in_the_heights_is_refused() {
        let mesh = patch_mesh(&Body::earth(), &Grid::new(8, false), MeshLayout::Aligned);
        let refused = glb(&mesh, &Body::earth(), "", None, |s, _| if s == 0 { f64::NAN } else { 0.0 });
        assert!(refused.unwrap_err().to_string().contains("finite"));
    }
}
