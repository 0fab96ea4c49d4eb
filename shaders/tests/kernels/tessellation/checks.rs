//! What the scheme promises, as checks that answer with the first breach.

use std::collections::HashMap;

use relief_shaders::leb::Corner;

use super::camera::{Vec3, dot, length, wide};
use super::planet::hash;
use super::scene::{Finder, Scene, drawn_point, places, weights};

/// A corner's name: a pole is one point whatever its S.
fn name(scene: &Scene<'_>, corner: &Corner) -> [u32; 2] {
    let pole = !scene.planet.plane && (corner.t == 0 || corner.t == 1 << 31);
    [if pole { 0 } else { corner.s }, corner.t]
}

/// Every edge in view belongs to two triangles, which run along it in opposite ways; a corner is
/// the same point in all its triangles.
pub fn watertight(scene: &Scene<'_>) -> Result<usize, String> {
    let mut points: HashMap<[u32; 2], (f32, [f32; 3])> = HashMap::new();
    let mut edges: HashMap<[[u32; 2]; 2], (i32, i32)> = HashMap::new();
    for triangle in &scene.mesh.triangles {
        for k in 0..3 {
            let (a, b) = (&triangle[k], &triangle[(k + 1) % 3]);
            let point = (a.height_m, scene.position_m(a));
            // == and not bits: at a pole a zero may have either sign.
            if *points.entry(name(scene, a)).or_insert(point) != point {
                return Err(format!("{a:?} is at two points"));
            }
            let (p, q) = (name(scene, a), name(scene, b));
            let edge = edges.entry([p.min(q), p.max(q)]).or_default();
            *(if p < q { &mut edge.0 } else { &mut edge.1 }) += 1;
        }
    }
    let axes = scene.camera.axes(scene.planet);
    for (&[p, q], &count) in &edges {
        if count == (1, 1) {
            continue;
        }
        let border = |v: usize| scene.planet.plane && p[v] == q[v] && (p[v] == 0 || p[v] == 1 << 31);
        if (border(0) || border(1)) && count.0 + count.1 == 1 {
            continue;
        }
        let ends = [p, q].map(|v| wide(points[&v].1));
        let Some([x, y]) = clip(scene, &axes, ends) else { continue };
        let at = |w: f64| [0, 1, 2].map(|i| ends[0][i] * (1.0 - w) + ends[1][i] * w);
        // Where the horizon hides it, an edge may lack a side.
        if (0..=8).all(|n| scene.is_hidden(at(x + (y - x) * f64::from(n) / 8.0), 400)) {
            continue;
        }
        return Err(format!("edge {p:?} {q:?} has {count:?} sides; {:?}", scene.camera));
    }
    Ok(edges.len())
}

/// The part of a segment inside the view, a little drawn in.
fn clip(scene: &Scene<'_>, axes: &[Vec3; 3], ends: [Vec3; 2]) -> Option<[f64; 2]> {
    let inside = |p: Vec3| {
        let [x, y, z] = axes.map(|axis| dot(axis, p));
        let slack = 2e-6 * length(p);
        let (tx, ty) = (scene.camera.tan_x(), scene.camera.tan_y());
        [z - scene.camera.near_m, tx * z - x, tx * z + x, ty * z - y, ty * z + y].map(|d| d - slack)
    };
    let [a, b] = ends.map(inside);
    let mut range = [0f64, 1.0];
    for (d0, d1) in a.into_iter().zip(b) {
        if d0 <= 0.0 && d1 <= 0.0 {
            return None;
        }
        let cut = d0 / (d0 - d1);
        if d0 < 0.0 {
            range[0] = range[0].max(cut);
        } else if d1 < 0.0 {
            range[1] = range[1].min(cut);
        }
    }
    (range[0] < range[1]).then_some(range)
}

/// The largest error at points of S_0 in view, pixels over what is allowed; negative is good.
/// Points over drawn triangles, and points that rays through pixels meet. `Err` when a ray's point
/// has no triangle: something visible was culled.
pub fn bounded(scene: &Scene<'_>, samples: u64, seed: u64) -> Result<Worst, String> {
    let finder = Finder::new(scene.planet, &scene.mesh.triangles);
    let axes = scene.camera.axes(scene.planet);
    let mut worst = Worst { excess_px: f64::NEG_INFINITY, largest_px: 0.0, seen: 0, rays: 0 };
    let count = scene.mesh.triangles.len() as u64;
    for n in 0..if count > 0 { samples } else { 0 } {
        let triangle = &scene.mesh.triangles[(hash(n, 1, seed) % count) as usize];
        let [u, v] = [2, 3].map(|k| (hash(n, k, seed) % 1001) as f64 / 1000.0);
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let w = [1.0 - u - v, u, v];
        let [s0, t0] = [triangle[0].s, triangle[0].t];
        let s = f64::from(s0) + (0..3).map(|k| w[k] * f64::from(triangle[k].s.wrapping_sub(s0) as i32)).sum::<f64>();
        let t = f64::from(t0) + (0..3).map(|k| w[k] * f64::from(triangle[k].t.wrapping_sub(t0) as i32)).sum::<f64>();
        let p = scene.camera.relative_m(scene.planet, s, t, scene.planet.height_m(s, t));
        worst.add(scene, &axes, p, drawn_point(scene, triangle, w));
    }
    for n in 0..samples / 8 {
        let [x, y] = [4, 5].map(|k| (hash(n, k, seed) % 20001) as f64 / 10000.0 - 1.0);
        let (x, y) = (x * scene.camera.tan_x(), y * scene.camera.tan_y());
        let d = [0, 1, 2].map(|i| axes[2][i] + axes[0][i] * x + axes[1][i] * y);
        let Some([s, t]) = scene.first_hit(d, 1500) else { continue };
        let p = scene.camera.relative_m(scene.planet, s, t, scene.planet.height_m(s, t));
        worst.rays += 1;
        match finder.find(s, t) {
            Some(triangle) => {
                let w = weights(places(&triangle), s, t);
                worst.add(scene, &axes, p, drawn_point(scene, &triangle, w));
            }
            None if scene.camera.sees(scene.camera.project(&axes, p)) && !scene.is_hidden(p, 100_000) => {
                return Err(format!("nothing is drawn over {s} {t}; {:?}", scene.camera));
            }
            None => {}
        }
    }
    Ok(worst)
}

#[derive(Clone, Copy, Debug)]
pub struct Worst {
    /// Largest error less what is allowed, pixels.
    pub excess_px: f64,
    /// Largest error, pixels.
    pub largest_px: f64,
    /// Points in view.
    pub seen: usize,
    /// Rays that met the ground.
    pub rays: usize,
}

impl Worst {
    fn add(&mut self, scene: &Scene<'_>, axes: &[Vec3; 3], truth: Vec3, drawn: Vec3) {
        let camera = &scene.camera;
        let [x, y, z] = camera.project(axes, truth);
        if !camera.sees([x, y, z]) {
            return;
        }
        let [u, v, depth] = camera.project(axes, drawn);
        let focal = camera.focal_px();
        let sec2 = (x * x + y * y) / (focal * focal) + 1.0;
        let error = if depth > 0.0 { (u - x).hypot(v - y) } else { f64::INFINITY };
        self.seen += 1;
        self.largest_px = self.largest_px.max(error);
        // Positions are within 5e-7 of the distance, heights rounded.
        let rounding = 5e-7 + height_rounding_m(scene) / z;
        self.excess_px = self.excess_px.max(error - camera.pixel_error - focal * sec2 * rounding);
    }
}

/// The largest error of a drawn corner's position, as a part of its distance; `Err` when a height
/// is not that of S_0: exactly at a node, to the rounding of a bilinear in f32 below level 0.
pub fn position_error(scene: &Scene<'_>) -> Result<f64, String> {
    let mut most = 0f64;
    for corner in scene.mesh.triangles.iter().flatten() {
        let (s, t, height) = (f64::from(corner.s), f64::from(corner.t), f64::from(corner.height_m));
        let truth = scene.planet.height_m(s, t);
        if (height - truth).abs() > if corner.level < 0 { height_rounding_m(scene) } else { 0.0 } {
            return Err(format!("{corner:?} is not {truth} m high"));
        }
        let exact = scene.camera.relative_m(scene.planet, s, t, height);
        let off = wide(scene.position_m(corner));
        most = most.max(length([0, 1, 2].map(|i| off[i] - exact[i])) / length(exact).max(1e-3));
    }
    Ok(most)
}

/// What a bilinear height in f32 may be off: two units in the last place of the greatest.
fn height_rounding_m(scene: &Scene<'_>) -> f64 {
    let [min, max] = scene.planet.range.map(|q| (f64::from(q) * scene.planet.step_m).abs());
    2.0 * f64::from(f32::EPSILON) * min.max(max)
}
