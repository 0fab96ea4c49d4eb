//! Sine and cosine of fixed-point angles, without the hardware's: WGSL promises those to 2^-11
//! only. Range reduction is a shift, so multiples of a right angle are exact.

/// Radians in one unit.
pub const UNIT_RAD: f32 = 1.462_918_1e-9;

/// Sine and cosine of an angle of -45 to 45 degrees in radians, to an ulp or two.
#[must_use]
pub fn sin_cos_small(rad: f32) -> [f32; 2] {
    let x2 = rad * rad;
    let sin = rad + rad * x2 * (-1.666_665_5e-1 + x2 * (8.332_161e-3 + x2 * -1.951_529_6e-4));
    let cos = 1.0 - 0.5 * x2 + x2 * x2 * (4.166_664_6e-2 + x2 * (-1.388_731_6e-3 + x2 * 2.443_315_7e-5));
    [sin, cos]
}

/// Sine and cosine of an angle in units of 2 pi / 2^32.
#[must_use]
pub fn sin_cos(units: u32) -> [f32; 2] {
    let quarter = units.wrapping_add(0x2000_0000) >> 30;
    let [sin, cos] = sin_cos_small(units.wrapping_sub(quarter << 30) as i32 as f32 * UNIT_RAD);
    match quarter {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

/// Sine and cosine of the geodetic latitude of T: exactly (+-1, 0) at the poles.
#[must_use]
pub fn sin_cos_lat(t: u32) -> [f32; 2] {
    sin_cos(t.wrapping_sub(0x4000_0000))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn right_angles_are_exact() {
        assert_eq!(sin_cos(0), [0.0, 1.0]);
        assert_eq!(sin_cos(1 << 30), [1.0, 0.0]);
        assert_eq!(sin_cos(1 << 31), [0.0, -1.0]);
        assert_eq!(sin_cos(3 << 30), [-1.0, 0.0]);
        assert_eq!(sin_cos_lat(0), [-1.0, 0.0]);
        assert_eq!(sin_cos_lat(1 << 31), [1.0, 0.0]);
    }

    proptest! {
        #[test]
        fn within_two_ulp_of_f64(units: u32) {
            let (sin, cos) = (f64::from(units) * std::f64::consts::TAU / 4_294_967_296.0).sin_cos();
            let got = sin_cos(units);
            prop_assert!((f64::from(got[0]) - sin).abs() < 1.2e-7, "{got:?} {sin} {cos}");
            prop_assert!((f64::from(got[1]) - cos).abs() < 1.2e-7, "{got:?} {sin} {cos}");
        }
    }
}
