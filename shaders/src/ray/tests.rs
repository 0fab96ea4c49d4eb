//! Rays against the same in f64.

use super::*;
use proptest::prelude::*;
use relief_formats::geodesy::{Ellipsoid, Geodetic};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const BODIES: [(f64, f64); 4] =
    [(6_378_137.0, 6_356_752.314_245), (1_737_400.0, 1_737_400.0), (3_396_190.0, 3_376_200.0), (900.0, 1_000.0)];

/// A ray and the same in f64: its planet, its start and direction in ECEF.
struct Pair {
    planet: Planet,
    ray: Ray,
    body: Ellipsoid,
    start: [f64; 3],
    direction: [f64; 3],
}

fn angle(units: u32) -> f64 {
    f64::from(units) * TAU / 4_294_967_296.0
}

impl Pair {
    fn new(body: usize, s: u32, t: u32, height: f64, azimuth: f64, elevation: f64) -> Self {
        let (a_m, b_m) = BODIES[body];
        let body = Ellipsoid { a_m, b_m };
        let planet = Planet { m: 12, a_m: a_m as f32, b_m: b_m as f32, e2: body.e2() as f32, ..Planet::default() };
        let height_m = (height * 0.001 * a_m) as f32;
        let local =
            [elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin()].map(|v| v as f32);
        let (lon, lat) = (angle(s) - PI, angle(t) - FRAC_PI_2);
        let ((sl, cl), (sp, cp)) = (lon.sin_cos(), lat.sin_cos());
        let axes = [[-sl, cl, 0.0], [-sp * cl, -sp * sl, cp], [cp * cl, cp * sl, sp]];
        let direction = [0, 1, 2].map(|k| (0..3).map(|n| f64::from(local[n]) * axes[n][k]).sum());
        let start = body.ecef_m(Geodetic { lon_rad: lon, lat_rad: lat, height_m: height_m.into() });
        Self { planet, ray: ray_from(&planet, s, t, height_m, local), body, start, direction }
    }

    fn at(&self, distance_m: f32) -> Geodetic {
        let point = [0, 1, 2].map(|k| self.start[k] + f64::from(distance_m) * self.direction[k]);
        self.body.geodetic_from_ecef(point)
    }
}

/// Difference of longitudes, radians.
fn turn(a: f64, b: f64) -> f64 {
    (a - b + PI).rem_euclid(TAU) - PI
}

proptest! {
    #[test]
    fn headings_are_angles(x in -1.0..1.0f32, y in -1.0..1.0f32) {
        prop_assume!(x.abs() + y.abs() > 1e-3);
        let error = turn(angle(ray_heading(x, y)), f64::from(y).atan2(f64::from(x)));
        prop_assert!(error.abs() < 3e-7, "{error}");
    }

    #[test]
    fn rises_are_those_of_f64(body in 0..4usize, s: u32, t in 0u32..=1 << 31, height in -1.7..1.4f64,
                              azimuth in 0.0..TAU, elevation in -0.1..1.5f64, share in -6.0..-1.2f64) {
        let pair = Pair::new(body, s, t, height, azimuth, elevation);
        let distance_m = (10f64.powf(share) * pair.body.a_m) as f32;
        let truth = pair.at(distance_m).height_m - f64::from(pair.ray.height_m);
        let got = f64::from(ray_rise_m(&pair.planet, &pair.ray, distance_m));
        // Earth: 1 mm and a millionth of the distance; more on the body that is a fifth longer than wide.
        let relative = if body == 3 { 2e-5 } else { 1e-6 };
        let allowed = 2e-10 * pair.body.a_m + relative * f64::from(distance_m);
        prop_assert!((got - truth).abs() <= allowed, "{got} {truth} at {distance_m}");
    }

    #[test]
    fn borders_are_crossed_where_they_are(body in 0..3usize, s: u32, t in (1u32 << 20)..(1 << 31) - (1 << 20),
                                          height in -1.7..1.4f64, azimuth in 0.0..TAU, elevation in -0.05..1.3f64,
                                          share in -6.0..-1.5f64, northward: bool) {
        let pair = Pair::new(body, s, t, height, azimuth, elevation);
        let (ray, planet) = (&pair.ray, &pair.planet);
        let units = (10f64.powf(share) * 4_294_967_296.0 / TAU) as u32;
        // A millionth of the distance, and a ten-millionth of a radian where it is crossed at an acute angle.
        let east = azimuth < PI;
        let border = if east { s.wrapping_add(units) } else { s.wrapping_sub(units) };
        let at_m = ray_meridian_at_m(ray, ray_meridian(planet, ray, border));
        if at_m < 0.2 * pair.body.a_m as f32 {
            let at = pair.at(at_m);
            let miss_m = turn(at.lon_rad, angle(border) - PI) * at.lat_rad.cos() * pair.body.a_m;
            prop_assert!(miss_m.abs() <= 1e-6 * f64::from(at_m) + 1e-9 * pair.body.a_m, "{miss_m} m at {at_m}");
        }
        let border = if northward { t.saturating_add(units).min(1 << 31) } else { t.saturating_sub(units) };
        let at_m = ray_parallel_at_m(planet, ray, ray_parallel(planet, ray, border), northward);
        if at_m < 0.2 * pair.body.a_m as f32 {
            let miss_m = (pair.at(at_m).lat_rad - (angle(border) - FRAC_PI_2)) * pair.body.a_m;
            prop_assert!(miss_m.abs() <= 2e-6 * f64::from(at_m) + 1e-9 * pair.body.a_m, "{miss_m} m at {at_m}");
        } else {
            // Not crossed in that sense: the ray never gets there from the other side.
            for k in 1..40 {
                let lat = pair.at((0.005 * f64::from(k) * pair.body.a_m) as f32).lat_rad;
                let beyond = lat - (angle(border) - FRAC_PI_2);
                prop_assert!(if northward { beyond < 1e-6 } else { beyond > -1e-6 }, "{beyond}");
            }
        }
    }
}

#[test]
fn a_ray_from_a_pole_keeps_to_a_meridian() {
    let planet = Planet { m: 12, a_m: 1000.0, b_m: 1000.0, ..Planet::default() };
    // From the North Pole, told on the meridian S = 0: east is a quarter turn on.
    let ray = ray_from(&planet, 0, 1 << 31, 0.0, [1.0, 0.0, 0.0]);
    assert_eq!([ray.east, ray.north], [0.0, -1.0]);
    assert!(ray.s.abs_diff(1 << 30) < 64);
    let south = ray_from(&planet, 0, 0, 0.0, [0.0, -0.6, 0.8]);
    assert_eq!([south.east, south.north], [0.0, 0.6]);
    assert!(south.s.abs_diff(1 << 31) < 64);
}
