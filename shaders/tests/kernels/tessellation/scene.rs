//! A planet, its pages, a camera and what the twin makes of them.

use std::collections::HashMap;

use relief_shaders::leb::{Corner, Mesh, Params, ReliefTriangle, Triangle, tessellate, triangle};
use relief_shaders::planet::View;
use relief_shaders::position::camera_relative_m;

use super::camera::{Camera, Vec3, length, wide};
use super::planet::TestPlanet;
use crate::page_set::PageSet;

pub struct Scene<'a> {
    pub planet: &'a TestPlanet,
    pub pages: &'a PageSet,
    pub camera: Camera,
    pub view: View,
    pub mesh: Mesh,
}

impl<'a> Scene<'a> {
    pub fn new(planet: &'a TestPlanet, pages: &'a PageSet, camera: Camera) -> Self {
        let view = camera.view(planet);
        let params = Params::new(&pages.planet, &view, 4_000_000, 2_000_000);
        let mesh = tessellate(&pages.pages(), &view, &params);
        assert!(!mesh.stats.overflow, "{camera:?} {:?}", mesh.stats);
        Self { planet, pages, camera, view, mesh }
    }

    /// Where the twin puts a corner.
    pub fn position_m(&self, corner: &Corner) -> [f32; 3] {
        camera_relative_m(&self.pages.planet, &self.view, corner.s, corner.t, corner.height_m)
    }

    /// True when the ground between the camera and a point (relative, metres) hides the point.
    pub fn is_hidden(&self, p: Vec3, steps: u32) -> bool {
        (1..steps).any(|k| {
            let x = f64::from(k) / f64::from(steps);
            let [s, t, h] = self.camera.geodetic(self.planet, p.map(|v| v * x));
            self.on_map(s, t) && h < self.planet.height_m(s, t) - 1e-6 * length(p)
        })
    }

    /// True of places that are on the map.
    pub fn on_map(&self, s: f64, t: f64) -> bool {
        let side = 2f64.powi(31);
        !self.planet.plane || (0.0..=side).contains(&s) && (0.0..=side).contains(&t)
    }

    /// The first point of S_0 on a ray, if the march meets one: (S, T).
    pub fn first_hit(&self, direction: Vec3, steps: u32) -> Option<[f64; 2]> {
        let top = self.camera.height_m.max(f64::from(self.view.camera_h_hi_m)).abs();
        let far =
            4.0 * (self.planet.a_m + top) + if self.planet.plane { 2f64.powi(32) * self.planet.unit_m } else { 0.0 };
        let at = |r: f64| self.camera.geodetic(self.planet, direction.map(|v| v * r));
        let below = |[s, t, h]: [f64; 3]| self.on_map(s, t) && h < self.planet.height_m(s, t);
        if below(at(0.0)) {
            return None;
        }
        let mut last = 0.0;
        for k in 1..=steps {
            // From a tenth of the near plane's distance on by equal factors.
            let x = f64::from(k) / f64::from(steps);
            let r = 0.1 * self.camera.near_m * (far / (0.1 * self.camera.near_m)).powf(x);
            if below(at(r)) {
                let (mut outside, mut inside) = (last, r);
                for _ in 0..60 {
                    let middle = 0.5 * (outside + inside);
                    *(if below(at(middle)) { &mut inside } else { &mut outside }) = middle;
                }
                let [s, t, _] = at(outside);
                return self.on_map(s, t).then_some([s, t]);
            }
            last = r;
        }
        None
    }
}

/// Drawn triangles by name, to find the one over a place.
pub struct Finder<'a> {
    plane: bool,
    drawn: HashMap<[u32; 4], &'a ReliefTriangle>,
    /// Edges that end at a pole: (pole's T, S and T of the other end), and the corners.
    polar: HashMap<[u32; 3], [Corner; 2]>,
}

impl<'a> Finder<'a> {
    pub fn new(planet: &TestPlanet, triangles: &'a [ReliefTriangle]) -> Self {
        let name = |t: &ReliefTriangle| {
            let half = |a: u32, b: u32| a.wrapping_add((b.wrapping_sub(a) as i32 >> 1) as u32);
            [half(t[1].s, t[2].s), half(t[1].t, t[2].t), t[0].s, t[0].t]
        };
        let mut polar = HashMap::new();
        for triangle in triangles.iter().filter(|_| !planet.plane) {
            for (a, b) in (0..3).flat_map(|k| [(k, (k + 1) % 3), ((k + 1) % 3, k)]) {
                if is_pole(triangle[a].t) {
                    polar.insert([triangle[a].t, triangle[b].s, triangle[b].t], [triangle[a], triangle[b]]);
                }
            }
        }
        Self { plane: planet.plane, drawn: triangles.iter().map(|t| (name(t), t)).collect(), polar }
    }

    /// The drawn triangle over (S, T), if any. One with two corners at the same pole is not drawn: it
    /// is the line in which its neighbours meet.
    pub fn find(&self, s: f64, t: f64) -> Option<ReliefTriangle> {
        let count = triangle::start_count(self.plane);
        let mut at: Triangle = (0..count).map(|i| triangle::start(self.plane, i)).find(|c| covers(c, s, t))?;
        loop {
            let [apex, ..] = at.corners();
            if let Some(found) = self.drawn.get(&[at.s, at.t, apex[0], apex[1]]) {
                return Some(**found);
            }
            if let Some(line) = self.polar_line(&at) {
                return Some(line);
            }
            if !at.divisible() {
                return None;
            }
            let [a, b] = at.halves();
            at = if covers(&a, s, t) { a } else { b };
        }
    }

    /// A triangle with two corners at the same pole, if the line that it is was drawn.
    fn polar_line(&self, triangle: &Triangle) -> Option<ReliefTriangle> {
        let corners = triangle.corners();
        let [other] = (0..3).filter(|&k| !is_pole(corners[k][1])).collect::<Vec<_>>()[..] else { return None };
        let pole = corners[(other + 1) % 3][1];
        let [end, far] = self.polar.get(&[pole, corners[other][0], corners[other][1]]).filter(|_| !self.plane)?;
        Some([0, 1, 2].map(|k| if k == other { *far } else { Corner { s: corners[k][0], ..*end } }))
    }
}

fn is_pole(t: u32) -> bool {
    t == 0 || t == 1 << 31
}

/// Weights of (S, T) among a triangle's corners.
pub fn weights(corners: [[u32; 2]; 3], s: f64, t: f64) -> [f64; 3] {
    let turn = 2f64.powi(32);
    let [a, b, c] = corners.map(|[cs, ct]| {
        // The nearest image of the corner, by the first corner's distance.
        let d = f64::from(corners[0][0]) - s;
        let near = d - turn * (d / turn).round();
        [near + f64::from(cs.wrapping_sub(corners[0][0]) as i32), f64::from(ct) - t]
    });
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let (x, y, z) = (cross(b, c), cross(c, a), cross(a, b));
    let sum = x + y + z;
    [x / sum, y / sum, z / sum]
}

fn covers(triangle: &Triangle, s: f64, t: f64) -> bool {
    weights(triangle.corners(), s, t).iter().all(|&w| w >= -1e-12)
}

/// Corners of a drawn triangle in fixed point.
pub fn places(triangle: &ReliefTriangle) -> [[u32; 2]; 3] {
    triangle.map(|c| [c.s, c.t])
}

/// The point of a drawn triangle with these weights, metres from the camera.
pub fn drawn_point(scene: &Scene<'_>, triangle: &ReliefTriangle, weights: [f64; 3]) -> Vec3 {
    let corners = [0, 1, 2].map(|i| wide(scene.position_m(&triangle[i])));
    [0, 1, 2].map(|i| (0..3).map(|k| weights[k] * corners[k][i]).sum())
}
