//! Corners of triangles as vertices in a frame of the camera: +X east, +Y up, +Z south; metres.
//!
//! Positions are f32, rounded once from f64: near the origin they are as exact as the file. Equal
//! corners are one vertex.

use std::collections::HashMap;

use relief_formats::geodesy::{lat_deg, lon_deg, sin_cos_deg};
use relief_runtime::frame::{Corner, ReliefTriangle};
use relief_runtime::planet::Planet;
use relief_runtime::view::Camera;

/// Vertices and triangles.
pub struct Vertices {
    /// Fixed point.
    pub places: Vec<[u32; 2]>,
    /// Metres.
    pub positions: Vec<[f32; 3]>,
    /// Three for a triangle.
    pub indices: Vec<u32>,
    frame: Frame,
}

/// A frame at the camera's foot, on the ellipsoid (a plane: at height 0), or above it.
struct Frame {
    plane: bool,
    origin_m: [f64; 3],
    /// East, up and south in ECEF.
    axes: [[f64; 3]; 3],
}

impl Vertices {
    /// Vertices of triangles around a point `origin_m` above (or below) the camera's foot.
    pub fn new(planet: &Planet, camera: &Camera, origin_m: f64, triangles: &[ReliefTriangle]) -> Self {
        let frame = Frame::new(planet, camera, origin_m);
        let mut known: HashMap<[u32; 3], u32> = HashMap::new();
        let (mut places, mut positions) = (Vec::new(), Vec::new());
        let mut indices: Vec<u32> = Vec::with_capacity(3 * triangles.len());
        for corner in triangles.iter().flatten() {
            let index = *known.entry([corner.s, corner.t, corner.height_m.to_bits()]).or_insert_with(|| {
                places.push([corner.s, corner.t]);
                positions.push(frame.of(planet, camera, corner));
                positions.len() as u32 - 1
            });
            indices.push(index);
        }
        Self { places, positions, indices, frame }
    }

    /// Unit normals of the relief at the vertices, in their frame: the mean over their triangles, by
    /// area.
    pub fn normals(&self) -> Vec<[f32; 3]> {
        let mut sums = vec![[0f64; 3]; self.positions.len()];
        for triangle in self.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| self.positions[triangle[k] as usize].map(f64::from));
            let (u, v): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
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

    /// A direction of the frame as east and north at a vertex's own place.
    pub fn at_place(&self, direction: [f32; 3], [s, t]: [u32; 2]) -> [f32; 2] {
        let [east, up, south] = direction.map(f64::from);
        if self.frame.plane {
            return [east as f32, -south as f32];
        }
        let towards = [0, 1, 2].map(|k| {
            let [e, u, s] = self.frame.axes;
            e[k] * east + u[k] * up + s[k] * south
        });
        let [east, _, south] = axes(s, t).map(|axis| (0..3).map(|k| axis[k] * towards[k]).sum::<f64>());
        [east as f32, -south as f32]
    }
}

impl Frame {
    fn new(planet: &Planet, camera: &Camera, above_m: f64) -> Self {
        match planet.ellipsoid() {
            Some(e) => Self {
                plane: false,
                origin_m: e.ecef_from_fixed_m(camera.s, camera.t, above_m),
                axes: axes(camera.s, camera.t),
            },
            None => Self { plane: true, origin_m: [0.0, above_m, 0.0], axes: [[0.0; 3]; 3] },
        }
    }

    fn of(&self, planet: &Planet, camera: &Camera, corner: &Corner) -> [f32; 3] {
        let height_m = f64::from(corner.height_m);
        let Some(ellipsoid) = planet.ellipsoid() else {
            let metres = |v: u32, origin: u32, unit_m: f32| (f64::from(v) - f64::from(origin)) * f64::from(unit_m);
            let uniform = planet.uniform();
            let x = metres(corner.s, camera.s, uniform.unit_x_m);
            let y = metres(corner.t, camera.t, uniform.unit_y_m);
            return [x as f32, (height_m - self.origin_m[1]) as f32, -y as f32];
        };
        let point_m = ellipsoid.ecef_from_fixed_m(corner.s, corner.t, height_m);
        self.axes.map(|axis| (0..3).map(|k| axis[k] * (point_m[k] - self.origin_m[k])).sum::<f64>() as f32)
    }
}

/// East, up and south of a place of a globe, in ECEF.
fn axes(s: u32, t: u32) -> [[f64; 3]; 3] {
    let ((sin_lon, cos_lon), (sin_lat, cos_lat)) = (sin_cos_deg(lon_deg(s)), sin_cos_deg(lat_deg(t)));
    let east = [-sin_lon, cos_lon, 0.0];
    let up = [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat];
    let south = [sin_lat * cos_lon, sin_lat * sin_lon, -cos_lat];
    [east, up, south]
}
