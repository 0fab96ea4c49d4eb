//! Where a point of the relief is, relative to the camera (DESIGN section 8): plain f32, and yet
//! within 5e-7 of the distance, because differences are taken between integers.

use crate::angle::{UNIT_RAD, sin_cos_lat, sin_cos_small};
use crate::planet::{Planet, View};

/// Sine of an angle of any size in radians, from half-angle pieces small enough for
/// [`sin_cos_small`]: (sine of the half, cosine of the half).
fn half_angle(rad: f32) -> [f32; 2] {
    // At most pi/2 for a half of +-pi: a quarter of it is within +-45 degrees.
    let [s, c] = sin_cos_small(0.25 * rad);
    [2.0 * s * c, c * c - s * s]
}

/// The point (S, T, height) in the camera's frame, metres from the camera.
#[must_use]
pub fn camera_relative_m(planet: &Planet, view: &View, s: u32, t: u32, height_m: f32) -> [f32; 3] {
    let dh = (height_m - view.camera_h_hi_m) - view.camera_h_lo_m;
    let ds = s.wrapping_sub(view.camera_s) as i32 as f32;
    let dt = t.wrapping_sub(view.camera_t) as i32 as f32;
    if planet.plane != 0 {
        return [ds * planet.unit_x_m, dt * planet.unit_y_m, dh];
    }
    let [sin0, cos0] = [view.sin_lat, view.cos_lat];
    let [sin1, cos1] = sin_cos_lat(t);
    let [sin_dp, cos_dp] = half_angle(dt * UNIT_RAD);
    // Sine and cosine of the latitude half way.
    let [sin_m, cos_m] = [sin0 * cos_dp + cos0 * sin_dp, cos0 * cos_dp - sin0 * sin_dp];
    let [d_sin, d_cos] = [2.0 * cos_m * sin_dp, -2.0 * sin_m * sin_dp];
    let w1 = (1.0 - planet.e2 * sin1 * sin1).sqrt();
    let dn = planet.a_m * planet.e2 * d_sin * (sin1 + sin0) / (view.w0 * w1 * (view.w0 + w1));
    let h0 = view.camera_h_hi_m;
    let rho = (view.n0_m + h0 + dn + dh) * cos1;
    let [sin_dl, cos_dl] = half_angle(ds * UNIT_RAD);
    [
        (dn + dh) * cos1 + (view.n0_m + h0) * d_cos - 2.0 * rho * sin_dl * sin_dl,
        2.0 * rho * sin_dl * cos_dl,
        ((1.0 - planet.e2) * dn + dh) * sin1 + ((1.0 - planet.e2) * view.n0_m + h0) * d_sin,
    ]
}
