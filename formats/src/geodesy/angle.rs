//! Fixed-point angles: 1 unit = 2 pi / 2^32 rad (9.3 mm of Earth's equator).
//!
//! S counts eastwards from longitude -180 and wraps by itself as a u32; T counts northwards from
//! the South Pole, 0 to 2^31. Both are exact in degrees as f64, so node and degree agree bit for
//! bit. A plane uses the range 0 to 2^31 in both directions (its side is 2^31 units), so that a
//! node step of level k is 2^(31 - m + k) units on every body.

use crate::grid::Grid;

/// T of the North Pole, and S and T of a plane's far edges.
pub const T_NORTH: u32 = 1 << 31;
/// Radians in one unit.
pub const UNIT_RAD: f64 = std::f64::consts::TAU / 4_294_967_296.0;

/// An angle that names no place: the caller corrects it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AngleError {
    /// A longitude that is infinite or not a number.
    #[error("longitude {0} degrees: must be a finite number (any turn is accepted)")]
    Longitude(f64),
    /// A latitude beyond a pole or not a number.
    #[error("latitude {0} degrees: must lie within -90 to 90")]
    Latitude(f64),
}

/// Longitude in degrees, any number of turns, to the nearest S. Error at most half a unit.
///
/// # Errors
/// A longitude that is not finite.
pub fn s_from_lon_deg(lon_deg: f64) -> Result<u32, AngleError> {
    if !lon_deg.is_finite() {
        return Err(AngleError::Longitude(lon_deg));
    }
    // The remainder is exact; dividing first keeps the one rounding far below a unit.
    let units = (lon_deg % 360.0 / 360.0 * 4_294_967_296.0).round() as i64;
    Ok((units + (1 << 31)).rem_euclid(1 << 32) as u32)
}

/// Geodetic latitude in degrees to the nearest T. Error at most half a unit.
///
/// # Errors
/// A latitude outside -90 to 90, or not a number.
pub fn t_from_lat_deg(lat_deg: f64) -> Result<u32, AngleError> {
    if !(-90.0..=90.0).contains(&lat_deg) {
        return Err(AngleError::Latitude(lat_deg));
    }
    Ok(((lat_deg / 180.0 * 2_147_483_648.0).round() + 1_073_741_824.0) as u32)
}

/// Longitude of S in degrees, in [-180, 180), exact.
#[must_use]
pub fn lon_deg(s: u32) -> f64 {
    (i64::from(s) - (1 << 31)) as f64 * (360.0 / 4_294_967_296.0)
}

/// Geodetic latitude of T in degrees, exact; T above 2^31 lies beyond the pole and means nothing.
#[must_use]
pub fn lat_deg(t: u32) -> f64 {
    (i64::from(t) - (1 << 30)) as f64 * (180.0 / 2_147_483_648.0)
}

/// Fixed-point coordinate of node column or row `index` of `level`; column W of a globe is 0.
/// `level` at most `grid.m`.
#[must_use]
pub const fn node_to_fixed(grid: Grid, level: u32, index: u32) -> u32 {
    ((index as u64) << (31 - grid.m + level)) as u32
}

/// The node column or row of `level` that lies exactly at a fixed-point coordinate, if any.
/// Inverse of [`node_to_fixed`].
#[must_use]
pub const fn node_of(grid: Grid, level: u32, fixed: u32) -> Option<u32> {
    let shift = 31 - grid.m + level;
    if shift < 32 && fixed.trailing_zeros() >= shift { Some(fixed >> shift) } else { None }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90 and symmetric about 45:
/// the range is reduced in degrees, where it costs no rounding.
#[must_use]
pub fn sin_cos_deg(deg: f64) -> (f64, f64) {
    let turn = deg % 360.0;
    let quarter = (turn / 90.0).round();
    let (sin, cos) = (turn - 90.0 * quarter).to_radians().sin_cos();
    match (quarter as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn landmarks() {
        assert_eq!(s_from_lon_deg(-180.0), Ok(0));
        assert_eq!(s_from_lon_deg(180.0), Ok(0));
        assert_eq!(s_from_lon_deg(540.0), Ok(0));
        assert_eq!(s_from_lon_deg(0.0), Ok(1 << 31));
        assert_eq!(s_from_lon_deg(-1e-12), Ok(1 << 31));
        assert_eq!(s_from_lon_deg(180.0 - 1e-12), Ok(0));
        assert!(s_from_lon_deg(1e300).is_ok());
        assert_eq!((t_from_lat_deg(-90.0), t_from_lat_deg(90.0)), (Ok(0), Ok(T_NORTH)));
        assert_eq!((lon_deg(0), lat_deg(0), lat_deg(T_NORTH)), (-180.0, -90.0, 90.0));
    }

    #[test]
    fn what_names_no_place_is_refused() {
        for lat in [f64::NAN, 90.000_000_1, -91.0, f64::INFINITY] {
            assert!(t_from_lat_deg(lat).is_err(), "{lat}");
        }
        for lon in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(s_from_lon_deg(lon).is_err(), "{lon}");
        }
    }

    #[test]
    fn quadrants_are_exact() {
        for (deg, expected) in [(0.0, (0.0, 1.0)), (90.0, (1.0, 0.0)), (180.0, (0.0, -1.0)), (-90.0, (-1.0, 0.0))] {
            assert_eq!(sin_cos_deg(deg), expected);
        }
        let (sin, cos) = sin_cos_deg(30.0);
        assert!((sin - 0.5).abs() < 1e-16 && (cos - 0.75f64.sqrt()).abs() < 2e-16);
    }

    proptest! {
        #[test]
        fn degrees_and_units_are_inverse(s: u32, t in 0..=T_NORTH) {
            prop_assert_eq!(s_from_lon_deg(lon_deg(s)), Ok(s));
            prop_assert_eq!(t_from_lat_deg(lat_deg(t)), Ok(t));
        }

        #[test]
        fn nodes_are_exact(m in 8u32..=20, level in 0u32..8, pick: u32, plane: bool) {
            let grid = Grid::new(m, plane);
            let column = pick % grid.width(level);
            let s = node_to_fixed(grid, level, column);
            prop_assert_eq!(node_of(grid, level, s), Some(column));
            prop_assert_eq!(node_of(grid, level, s | 1), None);
            if !plane {
                prop_assert_eq!(lon_deg(s), grid.lon_deg(level, i64::from(column)));
                prop_assert_eq!(s_from_lon_deg(grid.lon_deg(level, i64::from(column))), Ok(s));
                let row = pick % (grid.height(level) + 1);
                prop_assert_eq!(t_from_lat_deg(grid.lat_deg(level, i64::from(row))), Ok(node_to_fixed(grid, level, row)));
            }
        }

        #[test]
        fn sin_cos_agrees_with_radians(deg in -720.0..720.0f64) {
            let ((sin, cos), (sin_rad, cos_rad)) = (sin_cos_deg(deg), deg.to_radians().sin_cos());
            prop_assert!((sin - sin_rad).abs() < 4e-15 && (cos - cos_rad).abs() < 4e-15);
        }
    }
}
