//! What the scheme needs to know of planet and view besides [`Planet`] and [`View`], worked out
//! once in f64.

use bytemuck::{Pod, Zeroable};

use crate::planet::{Planet, View};

/// Relative slack for each rank: more than the rounding of a position (4.2e-7 of its distance) at
/// a node and at its parent, so that a parent is never judged closer or smaller than its children.
pub const SLACK: f32 = 2e-6;

/// `struct LebParams` of `wgsl/lib/leb_params.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Params {
    /// At most so many metres between points of equal height one unit of S and T apart.
    pub reach_m: f32,
    /// The surface over a flat triangle bulges by at most this times the square of half the
    /// hypotenuse in units, metres; 0 on a plane.
    pub curvature_m: f32,
    /// Its normals turn by at most this much a unit, radians; 0 on a plane.
    pub turn_rad: f32,
    /// Greatest less least height of the planet, metres.
    pub range_m: f32,
    /// Slack of heights for each rank, metres.
    pub slack_m: f32,
    /// Cosine of the angle between the view's axis and its corners.
    pub cos_corner: f32,
    /// 1 if the camera lies outside the ellipsoid that hides things.
    pub horizon: u32,
    /// Triangles that fit in a list of a pass.
    pub list_capacity: u32,
    /// From the frame of the camera, metres, to that in which the hiding ellipsoid is the unit
    /// sphere: factors for x and y, for z, and for lengths at most.
    pub squash: [f32; 3],
    /// Relief triangles that fit.
    pub relief_capacity: u32,
    /// In that frame: unit vector from the camera to the centre, x and z.
    pub axis: [f32; 2],
    /// Distance to the plane of the horizon along the axis.
    pub horizon_distance: f32,
    /// Sine of the horizon's cone.
    pub cone_sin: f32,
    /// Cosine of the horizon's cone.
    pub cone_cos: f32,
    /// Zero.
    pub padding: [u32; 3],
}

impl Params {
    /// For a planet and a view of it; lists of at most `list_capacity` triangles and
    /// `relief_capacity` relief triangles.
    #[must_use]
    pub fn new(planet: &Planet, view: &View, list_capacity: u32, relief_capacity: u32) -> Self {
        let (min_m, max_m) = (f64::from(planet.min_m), f64::from(planet.max_m));
        let highest = min_m.abs().max(max_m.abs());
        let (tan_x, tan_y) = (f64::from(view.tan_x), f64::from(view.tan_y));
        let mut params = Self {
            // 1 % more than rounding needs: balls are nested with room to spare.
            reach_m: (1.01 * f64::from(planet.unit_x_m.max(planet.unit_y_m))) as f32,
            range_m: planet.max_m - planet.min_m,
            slack_m: (highest * 5e-7) as f32,
            cos_corner: (0.999_999 / (1.0 + tan_x * tan_x + tan_y * tan_y).sqrt()) as f32,
            list_capacity,
            relief_capacity,
            ..Self::default()
        };
        if planet.plane == 0 {
            let unit_rad = std::f64::consts::TAU / 4_294_967_296.0;
            params.reach_m = (1.01 * unit_rad * (largest_radius_m(planet) + highest)) as f32;
            params.curvature_m = (1.000_01 * 0.5 * unit_rad * unit_rad * second_derivative_m(planet, highest)) as f32;
            params.turn_rad = (1.000_01 * unit_rad) as f32;
            params.set_horizon(planet, view);
        }
        params
    }

    /// The ellipsoid that hides is the planet's, scaled until all of it lies at heights below
    /// `min_m`: by 1 + min_m / (semi-axis), the smaller semi-axis for depths, the larger for
    /// heights. In units of its own axes the test is that of a sphere.
    fn set_horizon(&mut self, planet: &Planet, view: &View) {
        let (a, b, min_m) = (f64::from(planet.a_m), f64::from(planet.b_m), f64::from(planet.min_m));
        let scale = 1.0 + min_m / if min_m < 0.0 { a.min(b) } else { a.max(b) };
        let scale = scale * 0.999_999;
        let height = f64::from(view.camera_h_hi_m) + f64::from(view.camera_h_lo_m);
        let n = f64::from(view.n0_m);
        let x = (n + height) * f64::from(view.cos_lat) / (a * scale);
        let z = ((b / a) * (b / a) * n + height) * f64::from(view.sin_lat) / (b * scale);
        let distance = x.hypot(z);
        if scale <= 0.0 || distance <= 1.000_000_1 {
            return;
        }
        let tangent2 = (distance - 1.0) * (distance + 1.0);
        self.horizon = 1;
        self.squash = [1.0 / (a * scale), 1.0 / (b * scale), 1.0 / (a.min(b) * scale)].map(|v| v as f32);
        self.axis = [-x / distance, -z / distance].map(|v| v as f32);
        self.horizon_distance = (tangent2 / distance) as f32;
        self.cone_sin = (1.0 / distance) as f32;
        self.cone_cos = (tangent2.sqrt() / distance) as f32;
    }
}

/// The largest radius of curvature of the ellipsoid: a, a^2 / b or b^2 / a.
fn largest_radius_m(planet: &Planet) -> f64 {
    let (a, b) = (f64::from(planet.a_m), f64::from(planet.b_m));
    a.max(a * a / b).max(b * b / a)
}

/// A bound of the second derivative of E + h n by (longitude, latitude) in any unit direction.
///
/// On a sphere of radius R it is R sqrt(cos^2 + 4/3 sin^2 of the latitude) at most. On the
/// ellipsoid the radii are at most the largest one, and that of the meridian changes with the
/// latitude by 3 a (1 - e2) e2 sin cos / w^5, w^2 = 1 - e2 sin^2.
fn second_derivative_m(planet: &Planet, highest_m: f64) -> f64 {
    let (a, b) = (f64::from(planet.a_m), f64::from(planet.b_m));
    let e2 = (a - b) * (a + b) / (a * a);
    let w = (1.0 - e2.max(0.0)).sqrt();
    (4.0f64 / 3.0).sqrt() * (largest_radius_m(planet) + highest_m) + 1.5 * a * (1.0 - e2) * e2.abs() / w.powi(5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central second differences of E + h n in f64, in all directions at all latitudes.
    fn largest_second_derivative(a: f64, b: f64, h: f64) -> f64 {
        let point = |lon: f64, lat: f64| {
            let n = a * a / (a * lat.cos()).hypot(b * lat.sin());
            let rho = (n + h) * lat.cos();
            [rho * lon.cos(), rho * lon.sin(), (n * (b / a) * (b / a) + h) * lat.sin()]
        };
        let step = 1e-4;
        let mut most = 0f64;
        for lat in (-90..=90).map(|d| f64::from(d).to_radians()) {
            for turn in (0..180).map(|d| f64::from(d).to_radians()) {
                let (u, v) = (step * turn.sin(), step * turn.cos());
                let [p, q, r] = [-1.0, 0.0, 1.0].map(|k| point(k * u, lat + k * v));
                let second = [0, 1, 2].map(|i| (p[i] - 2.0 * q[i] + r[i]) / (step * step));
                most = most.max(second[0].hypot(second[1]).hypot(second[2]));
            }
        }
        most
    }

    #[test]
    fn the_second_derivative_is_bounded_and_not_loosely() {
        let bodies = [(6_378_137.0, 6_356_752.3), (1_737_400.0, 1_737_400.0), (1000.0, 700.0), (1000.0, 1300.0)];
        for (a, b) in bodies {
            for h in [0.0, 0.2 * a] {
                let planet = Planet { a_m: a as f32, b_m: b as f32, ..Planet::default() };
                let (bound, truth) = (second_derivative_m(&planet, h), largest_second_derivative(a, b, h));
                assert!(truth <= bound * 1.000_001, "{a} {b} {h}: {truth} beyond {bound}");
                assert!(bound < truth * if a == b { 1.001 } else { 2.5 }, "{a} {b} {h}: {bound} for {truth}");
                // The bound is no bound for a body a quarter larger.
                assert!(largest_second_derivative(1.25 * a, 1.25 * b, h) > truth * 1.15);
            }
        }
    }
}
