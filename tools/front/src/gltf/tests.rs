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
