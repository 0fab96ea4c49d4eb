//! How far a drawn mesh is from S_0, in f64, measured point by point.

use rayon::prelude::*;
use relief_formats::file::FormatError;
use relief_formats::geodesy::{T_NORTH, UNIT_RAD};
use relief_formats::surface::{Place, Surface};
use relief_shaders::leb::Corner;

use crate::planet::Planet;
use crate::view::View;

/// The distance between S_0 and what is drawn in its place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshError {
    /// Largest, pixels.
    pub largest_px: f64,
    /// Root of the mean square, pixels.
    pub rms_px: f64,
    /// Largest, metres.
    pub largest_m: f64,
    /// Root of the mean square, metres.
    pub rms_m: f64,
    /// Points measured: those in view.
    pub points: usize,
}

/// Measures about `points` points of S_0, spread over the triangles, against the points drawn with
/// the same barycentric weights; only those in view count. A point drawn nearer elsewhere is not
/// looked for, so the figures are upper bounds.
///
/// # Errors
/// A damaged tile.
pub fn measure(
    planet: &Planet,
    surface: &Surface<'_>,
    view: &View,
    triangles: &[[Corner; 3]],
    points: usize,
) -> Result<MeshError, FormatError> {
    let eye = Eye::of(planet, view);
    let each = points.div_ceil(triangles.len().max(1));
    let every = (triangles.len() / points.max(1)).max(1);
    let sums = triangles
        .par_iter()
        .enumerate()
        .filter(|(n, _)| n % every == 0)
        .map(|(n, corners)| {
            let mut sums = Sums::default();
            for k in 0..each {
                let weights = weights(n * each + k);
                let [s, t] = blend_angles(corners, weights);
                let place = place(planet, s, t);
                let truth = eye.relative_m(planet, s, t, surface.height_m(&place)?);
                let mut drawn = [0.0; 3];
                for (corner, w) in corners.iter().zip(weights) {
                    let at = eye.relative_m(planet, corner.s.into(), corner.t.into(), corner.height_m.into());
                    for axis in 0..3 {
                        drawn[axis] += w * at[axis];
                    }
                }
                sums.add(&eye, truth, drawn);
            }
            Ok::<_, FormatError>(sums)
        })
        .try_reduce(Sums::default, |a, b| Ok(a.and(b)))?;
    let count = sums.points.max(1) as f64;
    Ok(MeshError {
        largest_px: sums.largest_px,
        rms_px: (sums.square_px / count).sqrt(),
        largest_m: sums.largest_m,
        rms_m: (sums.square_m / count).sqrt(),
        points: sums.points,
    })
}

#[derive(Clone, Copy, Default)]
struct Sums {
    largest_px: f64,
    square_px: f64,
    largest_m: f64,
    square_m: f64,
    points: usize,
}

impl Sums {
    fn add(&mut self, eye: &Eye, truth: [f64; 3], drawn: [f64; 3]) {
        let (Some(a), Some(b)) = (eye.project_px(truth), eye.project_px(drawn)) else { return };
        if !eye.sees(a) {
            return;
        }
        let px = (a[0] - b[0]).hypot(a[1] - b[1]);
        let m = (0..3).map(|k| (truth[k] - drawn[k]).powi(2)).sum::<f64>().sqrt();
        self.largest_px = self.largest_px.max(px);
        self.largest_m = self.largest_m.max(m);
        self.square_px += px * px;
        self.square_m += m * m;
        self.points += 1;
    }

    fn and(self, other: Self) -> Self {
        Self {
            largest_px: self.largest_px.max(other.largest_px),
            square_px: self.square_px + other.square_px,
            largest_m: self.largest_m.max(other.largest_m),
            square_m: self.square_m + other.square_m,
            points: self.points + other.points,
        }
    }
}

/// Weights of the n-th point: the additive recurrence on the plastic number fills a square evenly.
fn weights(n: usize) -> [f64; 3] {
    let (u, v) = ((n as f64 * 0.754_877_666_246_693).fract(), (n as f64 * 0.569_840_290_998_053_3).fract());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    [1.0 - u - v, u, v]
}

/// Where the weights fall, in units that are not whole; S may leave 0..2^32.
fn blend_angles(corners: &[Corner; 3], weights: [f64; 3]) -> [f64; 2] {
    let first = corners[0].s;
    let s = |k: usize| f64::from(corners[k].s.wrapping_sub(first) as i32);
    let t = |k: usize| f64::from(corners[k].t);
    let sum = |f: &dyn Fn(usize) -> f64| (0..3).map(|k| weights[k] * f(k)).sum::<f64>();
    [f64::from(first) + sum(&s), sum(&t)]
}

/// The place of level 0 at S and T that need not be whole.
fn place(planet: &Planet, s: f64, t: f64) -> Place {
    let grid = planet.grid();
    let cell = f64::from(1u32 << (31 - grid.m));
    let width = f64::from(grid.width(0));
    let x = if grid.plane { (s / cell).clamp(0.0, width) } else { (s / cell).rem_euclid(width) };
    let y = (t / cell).clamp(0.0, f64::from(grid.height(0)));
    Place::from_cells(grid, 0, x, y)
}

/// Unit vectors to the right, up and forward in ECEF, or east, north and up on a plane.
fn axes(planet: &Planet, view: &View) -> [[f64; 3]; 3] {
    let camera = &view.camera;
    let [heading, pitch, roll] = [camera.heading_deg, camera.pitch_deg, camera.roll_deg].map(f64::to_radians);
    let [east, north, zenith] = match planet.ellipsoid() {
        Some(_) => {
            let lon = (f64::from(camera.s) - f64::from(T_NORTH)) * UNIT_RAD;
            let lat = (f64::from(camera.t) - f64::from(T_NORTH / 2)) * UNIT_RAD;
            [
                [-lon.sin(), lon.cos(), 0.0],
                [-lat.sin() * lon.cos(), -lat.sin() * lon.sin(), lat.cos()],
                [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()],
            ]
        }
        None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    let mix = |a: f64, u: [f64; 3], b: f64, v: [f64; 3]| std::array::from_fn(|k| a * u[k] + b * v[k]);
    let ahead = mix(heading.sin(), east, heading.cos(), north);
    let right = mix(heading.cos(), east, -heading.sin(), north);
    let forward = mix(pitch.cos(), ahead, pitch.sin(), zenith);
    let up = mix(-pitch.sin(), ahead, pitch.cos(), zenith);
    [mix(roll.cos(), right, -roll.sin(), up), mix(roll.cos(), up, roll.sin(), right), forward]
}

/// The camera, in f64.
struct Eye {
    at_m: [f64; 3],
    axes: [[f64; 3]; 3],
    focal_px: f64,
    half_px: [f64; 2],
}

impl Eye {
    fn of(planet: &Planet, view: &View) -> Self {
        let camera = &view.camera;
        let mut eye = Self {
            at_m: [0.0; 3],
            axes: axes(planet, view),
            focal_px: f64::from(view.height) / (2.0 * (camera.fov_deg / 2.0).to_radians().tan()),
            half_px: [f64::from(view.width) / 2.0, f64::from(view.height) / 2.0],
        };
        eye.at_m = eye.relative_m(planet, camera.s.into(), camera.t.into(), camera.height_m);
        eye
    }

    /// A point from the camera, metres: in ECEF, or east, north and up on a plane.
    fn relative_m(&self, planet: &Planet, s: f64, t: f64, height_m: f64) -> [f64; 3] {
        let point = match planet.ellipsoid() {
            Some(e) => {
                let (lon_rad, lat_rad) = ((s - f64::from(T_NORTH)) * UNIT_RAD, (t - f64::from(T_NORTH / 2)) * UNIT_RAD);
                e.ecef_m(relief_formats::geodesy::Geodetic { lon_rad, lat_rad, height_m })
            }
            None => {
                let uniform = planet.uniform();
                [s * f64::from(uniform.unit_x_m), t * f64::from(uniform.unit_y_m), height_m]
            }
        };
        std::array::from_fn(|k| point[k] - self.at_m[k])
    }

    /// Pixels right of and above the picture's middle; none behind the camera.
    fn project_px(&self, p: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = self.axes.map(|axis| (0..3).map(|k| axis[k] * p[k]).sum::<f64>());
        (z > f64::from(crate::view::NEAR_M)).then(|| [self.focal_px * x / z, self.focal_px * y / z])
    }

    fn sees(&self, [x, y]: [f64; 2]) -> bool {
        x.abs() <= self.half_px[0] && y.abs() <= self.half_px[1]
    }
}
