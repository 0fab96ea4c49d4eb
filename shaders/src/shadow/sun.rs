//! The sun: its direction at a point, its disk, and the air's refraction.

use crate::angle::{sin_cos, sin_cos_lat};

/// (east, north, up) at (S, T) of a direction with x outwards from the polar axis on the meridian
/// `s_origin`, y east of it, z along the axis. ECEF has `s_origin` 2^31 (longitude 0); a view's
/// directions that of its camera. Error 3e-7 rad.
#[must_use]
#[inline]
pub fn sun_local(direction: [f32; 3], s_origin: u32, s: u32, t: u32) -> [f32; 3] {
    let [sin_lon, cos_lon] = sin_cos(s.wrapping_sub(s_origin));
    let [sin_lat, cos_lat] = sin_cos_lat(t);
    let [x, y, z] = direction;
    let outwards = cos_lon * x + sin_lon * y;
    [cos_lon * y - sin_lon * x, cos_lat * z - sin_lat * outwards, cos_lat * outwards + sin_lat * z]
}

/// Slopes (metres above the ray to the disk's centre, a metre of distance) of the disk's lower and
/// upper limb. A disk near the zenith counts as a point: nothing shades a part of it.
#[must_use]
#[inline]
pub fn disk_slopes(sun: [f32; 3], disk_rad: f32) -> [f32; 2] {
    let [east, north, up] = sun;
    let cos = (east * east + north * north).sqrt();
    if cos < 16.0 * disk_rad || disk_rad == 0.0 {
        return [0.0, 0.0];
    }
    // sin(r) / cos(elevation +- r).
    [-disk_rad / (cos + disk_rad * up), disk_rad / (cos - disk_rad * up)]
}

/// Visible part of the disk above relief of a slope: the segment of a circle that a straight
/// horizon leaves.
#[must_use]
#[inline]
pub fn visible_part(slope: f32, sun: [f32; 3], disk_rad: f32) -> f32 {
    let [east, north, up] = sun;
    let cos = (east * east + north * north).sqrt();
    if cos < 16.0 * disk_rad || disk_rad == 0.0 {
        return if slope > 0.0 { 0.0 } else { 1.0 };
    }
    // Relief beyond the zenith hides all of it.
    let under = 1.0 + slope * up;
    let x = if under > 0.0 { (slope * cos / (under * disk_rad)).clamp(-1.0, 1.0) } else { 1.0 };
    let area = arc_cos(x) - x * (1.0 - x * x).max(0.0).sqrt();
    (area * std::f32::consts::FRAC_1_PI).clamp(0.0, 1.0)
}

/// Arc cosine in radians for x of -1 to 1, within 7e-5 (Abramowitz and Stegun 4.4.45).
fn arc_cos(x: f32) -> f32 {
    let z = x.abs();
    let arc = (1.0 - z).max(0.0).sqrt() * (1.570_728_8 + z * (-0.212_114_4 + z * (0.074_261 + z * -0.018_729_3)));
    if x < 0.0 { std::f32::consts::PI - arc } else { arc }
}

/// The sun as air lifts it: Saemundsson's formula (Sky & Telescope 72, 1986) for a true elevation,
/// 1.02' / tan(e + 10.3 / (e + 5.11)) in degrees, at 1010 hPa and 10 degrees Celsius, times
/// `density` (1 on Earth at sea level). Below -1.9 degrees it is that at -1.9 degrees.
#[must_use]
#[inline]
pub fn refracted(sun: [f32; 3], density: f32) -> [f32; 3] {
    let [east, north, up] = sun;
    let cos = (east * east + north * north).sqrt();
    if cos == 0.0 {
        return sun;
    }
    let elevation_deg = up.atan2(cos).to_degrees().max(-1.9);
    let argument = (elevation_deg + 10.3 / (elevation_deg + 5.11)).to_radians();
    let lift_rad = (density * 1.02 / 60.0 / argument.tan()).max(0.0).to_radians();
    let [sin_lift, cos_lift] = [lift_rad.sin(), lift_rad.cos()];
    let scale = (cos * cos_lift - up * sin_lift) / cos;
    [east * scale, north * scale, up * cos_lift + cos * sin_lift]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_horizon_rises_by_half_a_degree() {
        let [_, north, up] = refracted([0.0, 1.0, 0.0], 1.0);
        let minutes = up.atan2(north).to_degrees() * 60.0;
        // The Astronomical Almanac's 29' for a true elevation of 0 (34' for an apparent one).
        assert!((minutes - 28.98).abs() < 0.1, "{minutes}");
        assert_eq!(refracted([0.0, 0.0, 1.0], 1.0), [0.0, 0.0, 1.0]);
        assert_eq!(refracted([0.6, 0.0, 0.8], 0.0), [0.6, 0.0, 0.8]);
    }

    #[test]
    fn the_disk_shows_half_above_its_centre() {
        let sun = [0.0, 0.98f32.sqrt(), 0.02f32.sqrt()];
        let [least, most] = disk_slopes(sun, 0.004_65);
        assert!((visible_part(0.0, sun, 0.004_65) - 0.5).abs() < 1e-4);
        assert!(visible_part(least, sun, 0.004_65) > 0.999 && visible_part(most, sun, 0.004_65) < 0.001);
        // The area above a chord at half the radius: acos(1/2) - sqrt(3)/4, of pi.
        let half = visible_part(0.5 * most, sun, 0.004_65);
        assert!((half - 0.195_5).abs() < 1e-3, "{half}");
    }

    proptest! {
        #[test]
        fn local_directions_are_those_of_f64(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64,
                                             s: u32, t in 0u32..=1 << 31) {
            let n = (x * x + y * y + z * z).sqrt();
            prop_assume!(n > 0.1);
            let d = [x / n, y / n, z / n];
            let lon = f64::from(s) * std::f64::consts::TAU / 4_294_967_296.0 - std::f64::consts::PI;
            let lat = f64::from(t) * std::f64::consts::TAU / 4_294_967_296.0 - std::f64::consts::FRAC_PI_2;
            let e = -lon.sin() * d[0] + lon.cos() * d[1];
            let r = lon.cos() * d[0] + lon.sin() * d[1];
            let truth = [e, lat.cos() * d[2] - lat.sin() * r, lat.cos() * r + lat.sin() * d[2]];
            let got = sun_local(d.map(|v| v as f32), 1 << 31, s, t);
            for (g, w) in got.iter().zip(truth) {
                prop_assert!((f64::from(*g) - w).abs() < 3e-7, "{got:?} {truth:?}");
            }
        }
    }
}
