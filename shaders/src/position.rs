//! Where a point of the relief is, relative to the camera: plain f32, and yet
//! within 5e-7 of the distance, because differences are taken between integers.

use crate::angle::{UNIT_RAD, sin_cos, sin_cos_lat, sin_cos_small};
use crate::planet::{Planet, View};

/// Sine and cosine of half an angle in units; beyond 90 degrees the lost half unit is nothing.
fn half_angle(units: i32) -> [f32; 2] {
    if units.unsigned_abs() <= 1 << 30 {
        return sin_cos_small(0.5 * (units as f32 * UNIT_RAD));
    }
    sin_cos((units >> 1) as u32)
}

/// a - b where nothing wraps.
fn difference(a: u32, b: u32) -> f32 {
    if a >= b { (a - b) as f32 } else { -((b - a) as f32) }
}

/// The point (S, T, height) in the camera's frame, metres from the camera.
#[must_use]
pub fn camera_relative_m(planet: &Planet, view: &View, s: u32, t: u32, height_m: f32) -> [f32; 3] {
    let dh = (height_m - view.camera_h_hi_m) - view.camera_h_lo_m;
    let ds = s.wrapping_sub(view.camera_s) as i32;
    let dt = t.wrapping_sub(view.camera_t) as i32;
    if planet.plane != 0 {
        let [east, north] = [difference(s, view.camera_s), difference(t, view.camera_t)];
        return [east * planet.unit_x_m, north * planet.unit_y_m, dh];
    }
    let sin0 = view.sin_lat;
    let [sin1, cos1] = sin_cos_lat(t);
    // Half way between the latitudes, to half a unit.
    let [sin_m, cos_m] = sin_cos_lat((t >> 1) + (view.camera_t >> 1) + (t & view.camera_t & 1));
    let [sin_dp, _] = half_angle(dt);
    let [d_sin, d_cos] = [2.0 * cos_m * sin_dp, -2.0 * sin_m * sin_dp];
    let w1 = (1.0 - planet.e2 * sin1 * sin1).sqrt();
    let dn = planet.a_m * planet.e2 * d_sin * (sin1 + sin0) / (view.w0 * w1 * (view.w0 + w1));
    let h0 = view.camera_h_hi_m;
    let rho = (view.n0_m + h0 + dn + dh) * cos1;
    let [sin_l, cos_l] = sin_cos(ds as u32);
    // A pole has any longitude and one position.
    let x = if ds.unsigned_abs() <= 1 << 30 || cos1 == 0.0 {
        let [sin_dl, _] = half_angle(ds);
        (dn + dh) * cos1 + (view.n0_m + h0) * d_cos - 2.0 * rho * sin_dl * sin_dl
    } else {
        // On the other side of the axis nothing cancels.
        rho * cos_l - (view.n0_m + h0 + view.camera_h_lo_m) * view.cos_lat
    };
    [x, rho * sin_l, ((1.0 - planet.e2) * dn + dh) * sin1 + ((1.0 - planet.e2) * view.n0_m + h0) * d_sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use relief_formats::geodesy::{Ellipsoid, lat_deg, lon_deg};

    const BODIES: [(f64, f64); 5] = [
        (6_378_137.0, 6_356_752.314_245),
        (1_737_400.0, 1_737_400.0),
        (3_396_190.0, 3_376_200.0),
        (900.0, 1_000.0),
        (1_000.0, 800.0),
    ];

    fn view(body: Ellipsoid, s: u32, t: u32, height_m: f64) -> View {
        let (sin, cos) = lat_deg(t).to_radians().sin_cos();
        let w = (1.0 - body.e2() * sin * sin).sqrt();
        let hi = height_m as f32;
        View {
            camera_s: s,
            camera_t: t,
            camera_h_hi_m: hi,
            camera_h_lo_m: (height_m - f64::from(hi)) as f32,
            sin_lat: sin as f32,
            cos_lat: cos as f32,
            n0_m: (body.a_m / w) as f32,
            w0: w as f32,
            ..View::default()
        }
    }

    /// Error as a share of the distance, against ECEF differences in f64.
    fn relative_error(body: Ellipsoid, camera: (u32, u32, f64), point: (u32, u32, f32)) -> f64 {
        let planet = Planet { a_m: body.a_m as f32, b_m: body.b_m as f32, e2: body.e2() as f32, ..Planet::default() };
        let got = camera_relative_m(&planet, &view(body, camera.0, camera.1, camera.2), point.0, point.1, point.2);
        let from = body.ecef_from_fixed_m(camera.0, camera.1, camera.2);
        let to = body.ecef_from_fixed_m(point.0, point.1, f64::from(point.2));
        let (sin, cos) = lon_deg(camera.0).to_radians().sin_cos();
        let d = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        let truth = [d[0] * cos + d[1] * sin, d[1] * cos - d[0] * sin, d[2]];
        let error = (0..3).map(|i| (f64::from(got[i]) - truth[i]).powi(2)).sum::<f64>().sqrt();
        let distance = truth.iter().map(|v| v * v).sum::<f64>().sqrt();
        // f64 itself knows ECEF no better than a nanometre.
        error / distance.max(1e-2)
    }

    fn near(at: u32, span: f64, unit: f64) -> u32 {
        at.wrapping_add((span * unit) as i64 as u32)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn within_5e7_of_the_distance(
            body in 0usize..5, s: u32, t in 0..=1u32 << 31, scale in 0.0..9.3f64,
            u in -1.0..1.0f64, v in -1.0..1.0f64, up in 0.0..1.0f64, relief in -1.0..1.0f64, pole in 0..5, radii in -3.0..1.0f64,
        ) {
            let (a_m, b_m) = BODIES[body];
            let t = match pole { 0 => t >> 20, 1 => (1 << 31) - (t >> 20), _ => t };
            let high_m = if pole == 3 { a_m * 10f64.powf(radii) } else { 0.0 };
            let span = 10f64.powf(scale);
            let camera_t = (i64::from(t) + (span * v) as i64).clamp(0, 1 << 31) as u32;
            let camera_t = if pole == 4 { camera_t >> 31 << 31 } else { camera_t };
            let height = (relief * a_m * 1.5e-3) as f32;
            let camera_m = f64::from(height) + up * span * 1e-9 * a_m + a_m * 1e-7 + high_m;
            let error = relative_error(Ellipsoid { a_m, b_m }, (near(s, span, u), camera_t, camera_m), (s, t, height));
            prop_assert!(error < 5e-7, "{error:e} of the distance");
        }
    }

    #[test]
    fn a_plane_does_not_wrap() {
        let planet = Planet { plane: 1, unit_x_m: 0.5, unit_y_m: 0.25, ..Planet::default() };
        let far = camera_relative_m(&planet, &View::default(), 1 << 31, 1 << 31, 7.0);
        assert_eq!(far, [2f32.powi(30), 2f32.powi(29), 7.0]);
        let view = View { camera_s: 1 << 31, camera_t: 5, ..View::default() };
        assert_eq!(camera_relative_m(&planet, &view, 0, 1, 0.0), [-(2f32.powi(30)), -1.0, 0.0]);
    }

    #[test]
    fn a_pole_is_one_point() {
        let body = Ellipsoid { a_m: BODIES[0].0, b_m: BODIES[0].1 };
        let planet = Planet { a_m: body.a_m as f32, b_m: body.b_m as f32, e2: body.e2() as f32, ..Planet::default() };
        for t in [0, 1 << 31] {
            let view = view(body, 77, t ^ 12345, 3000.0);
            let first = camera_relative_m(&planet, &view, 0, t, 100.0).map(f32::to_bits);
            for s in (1..64).map(|i| i << 26) {
                let other = camera_relative_m(&planet, &view, s, t, 100.0);
                assert_eq!(other.map(|v| (v + 0.0).to_bits()), first.map(|v| (f32::from_bits(v) + 0.0).to_bits()));
            }
        }
    }
}
