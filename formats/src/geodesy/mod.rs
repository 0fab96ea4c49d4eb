//! Geodesy in f64: geodetic coordinates, ECEF, and the fixed-point angles of the grid.
//!
//! phi is the geodetic longitude, psi the geodetic latitude, h the height along the normal of an
//! ellipsoid of revolution with semi-axes a (equator) and b (pole). Nothing assumes a >= b.

mod angle;

pub use angle::{
    AngleError, T_NORTH, UNIT_RAD, lat_deg, lon_deg, node_of, node_to_fixed, s_from_lon_deg, sin_cos_deg,
    t_from_lat_deg,
};

use crate::body::Body;

/// A point by longitude, latitude and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geodetic {
    /// Longitude, radians, in (-pi, pi]; 0 on the polar axis.
    pub lon_rad: f64,
    /// Geodetic latitude, radians, in [-pi/2, pi/2].
    pub lat_rad: f64,
    /// Height along the normal, metres.
    pub height_m: f64,
}

/// An ellipsoid of revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Equatorial semi-axis, metres, positive.
    pub a_m: f64,
    /// Polar semi-axis, metres, positive.
    pub b_m: f64,
}

impl Ellipsoid {
    /// The body's ellipsoid; none for a plane.
    #[must_use]
    pub fn of(body: &Body) -> Option<Self> {
        match *body {
            Body::Ellipsoid { a_m, b_m, .. } => Some(Self { a_m, b_m }),
            Body::Plane { .. } => None,
        }
    }

    /// First eccentricity squared, 1 - b^2/a^2; negative for a prolate body.
    #[must_use]
    pub fn e2(&self) -> f64 {
        (self.a_m - self.b_m) * (self.a_m + self.b_m) / (self.a_m * self.a_m)
    }

    /// Prime vertical radius of curvature N(psi), metres (000, eq. 4), in the form
    /// a^2 / sqrt(a^2 cos^2 psi + b^2 sin^2 psi), which also holds for b > a.
    #[must_use]
    pub fn prime_vertical_radius_m(&self, lat_rad: f64) -> f64 {
        self.radius_m(lat_rad.sin_cos())
    }

    fn radius_m(&self, (sin_lat, cos_lat): (f64, f64)) -> f64 {
        self.a_m * self.a_m / (self.a_m * cos_lat).hypot(self.b_m * sin_lat)
    }

    /// Geodetic to ECEF, metres (000, eq. 2 and 6; z depends on psi, which eq. 2 misprints).
    #[must_use]
    pub fn ecef_m(&self, at: Geodetic) -> [f64; 3] {
        self.ecef_from_sin_cos(at.lon_rad.sin_cos(), at.lat_rad.sin_cos(), at.height_m)
    }

    /// Geodetic in degrees to ECEF, metres. Multiples of 90 degrees are exact: a pole is
    /// (0, 0, +-(b + h)) whatever its longitude.
    #[must_use]
    pub fn ecef_from_deg_m(&self, lon_deg: f64, lat_deg: f64, height_m: f64) -> [f64; 3] {
        self.ecef_from_sin_cos(sin_cos_deg(lon_deg), sin_cos_deg(lat_deg), height_m)
    }

    /// Fixed-point (S, T) to ECEF, metres (000, eq. 3 corrected). The same (S, T) gives the same
    /// bits, so the two sides of the seam and all vertices of a pole coincide.
    #[must_use]
    pub fn ecef_from_fixed_m(&self, s: u32, t: u32, height_m: f64) -> [f64; 3] {
        self.ecef_from_deg_m(lon_deg(s), lat_deg(t), height_m)
    }

    fn ecef_from_sin_cos(&self, lon: (f64, f64), lat: (f64, f64), height_m: f64) -> [f64; 3] {
        let radius_m = self.radius_m(lat);
        let polar_m = radius_m * (self.b_m / self.a_m) * (self.b_m / self.a_m);
        let rho_m = (radius_m + height_m) * lat.1;
        // + 0.0 turns -0.0 into 0.0: equal points have equal bits.
        [rho_m * lon.1 + 0.0, rho_m * lon.0 + 0.0, (polar_m + height_m) * lat.0 + 0.0]
    }

    /// Outward unit normal at a point ON the ellipsoid (000, eq. 5), parallel to
    /// (x, y, (a^2/b^2) z). Not a number at the centre.
    #[must_use]
    pub fn normal_at(&self, point_m: [f64; 3]) -> [f64; 3] {
        let ratio = self.a_m / self.b_m;
        let [x, y, z] = [point_m[0], point_m[1], point_m[2] * ratio * ratio];
        let length = x.hypot(y).hypot(z);
        [x / length, y / length, z / length]
    }

    /// Outward unit normal at geodetic degrees.
    #[must_use]
    pub fn normal_from_deg(lon_deg: f64, lat_deg: f64) -> [f64; 3] {
        let ((sin_lon, cos_lon), (sin_lat, cos_lat)) = (sin_cos_deg(lon_deg), sin_cos_deg(lat_deg));
        [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat]
    }

    /// (x/a)^2 + (y/a)^2 + (z/b)^2 - 1: zero on the ellipsoid, about 2 h / a above it.
    #[must_use]
    pub fn implicit(&self, point_m: [f64; 3]) -> f64 {
        (point_m[0] / self.a_m).hypot(point_m[1] / self.a_m).hypot(point_m[2] / self.b_m).powi(2) - 1.0
    }

    /// ECEF to geodetic: the nearest point of the ellipsoid and the signed distance to it. Holds
    /// anywhere, centre and axes included; where several points are nearest (the disc of the
    /// evolute) the northern one. The error is a few units in the last place of the coordinates.
    #[must_use]
    pub fn geodetic_from_ecef(&self, point_m: [f64; 3]) -> Geodetic {
        let [x, y, z] = point_m;
        let rho = x.hypot(y);
        let normal = if self.a_m >= self.b_m {
            foot_normal([rho, z.abs()], [self.a_m, self.b_m])
        } else {
            let [n_z, n_rho] = foot_normal([z.abs(), rho], [self.b_m, self.a_m]);
            [n_rho, n_z]
        };
        let (sin_lat, cos_lat) = (normal[1], normal[0]);
        // The error of this height is quadratic in the error of the latitude.
        let height_m = rho * cos_lat + z.abs() * sin_lat - (self.a_m * cos_lat).hypot(self.b_m * sin_lat);
        Geodetic { lon_rad: y.atan2(x + 0.0), lat_rad: sin_lat.atan2(cos_lat).copysign(z + 0.0), height_m }
    }
}

/// Unit normal, in the first quadrant, of the ellipse with semi-axes e0 >= e1 at its point
/// nearest to (y0, y1) >= 0.
///
/// With r0 = (e0/e1)^2 the foot is (r0 y0 / (u + r0 - 1), y1 / u), where u > 0 is the root of a
/// convex falling function; Newton's method from a lower bound climbs to it without overshoot.
fn foot_normal([y0, y1]: [f64; 2], [e0, e1]: [f64; 2]) -> [f64; 2] {
    let excess = (e0 - e1) * (e0 + e1) / (e1 * e1);
    let (z0, z1) = (y0 / e0, y1 / e1);
    let first = (1.0 + excess) * z0;
    let mut u = z1.max(first - excess);
    // Nearer to the long axis than 1e-16 e1 and inside the evolute: on the axis.
    if z1 < 1e-16 && first <= excess {
        let cos = if excess > 0.0 { first / excess } else { 0.0 };
        return unit([cos / e0, (1.0 - cos * cos).max(0.0).sqrt() / e1]);
    }
    for _ in 0..128 {
        let (p, q) = (first / (u + excess), z1 / u);
        let value = p * p + q * q - 1.0;
        let slope = -2.0 * (p * p / (u + excess) + q * q / u);
        let next = u - value / slope;
        if next.is_nan() || next <= u {
            break;
        }
        u = next;
    }
    unit([y0 / (u + excess), y1 / u])
}

fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y);
    [x / length, y / length]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn earth() -> Ellipsoid {
        Ellipsoid::of(&Body::earth()).unwrap()
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
    }

    #[test]
    fn wgs84_constants_are_the_published_ones() {
        let e = earth();
        assert!((e.b_m - 6_356_752.314_245).abs() < 1e-6);
        assert!((e.e2() - 6.694_379_990_14e-3).abs() < 1e-14);
        // a^2 / b, the polar radius of curvature (NGA.STND.0036, table 3.5).
        assert!((e.prime_vertical_radius_m(std::f64::consts::FRAC_PI_2) - 6_399_593.625_8).abs() < 1e-4);
    }

    #[test]
    fn axes_are_exact() {
        let e = earth();
        assert_eq!(e.ecef_from_deg_m(0.0, 0.0, 0.0), [e.a_m, 0.0, 0.0]);
        assert_eq!(e.ecef_from_deg_m(90.0, 0.0, 10.0), [0.0, e.a_m + 10.0, 0.0]);
        for lon in [-180.0, -33.3, 0.0, 71.0] {
            let pole = e.ecef_from_deg_m(lon, -90.0, 5.0);
            assert_eq!((pole[0], pole[1]), (0.0, 0.0));
            assert!((pole[2] + e.b_m + 5.0).abs() < 2e-9);
        }
        assert_eq!(e.ecef_from_fixed_m(0, 1 << 30, 0.0), [-e.a_m, 0.0, 0.0]);
    }

    #[test]
    fn known_points() {
        // From GeographicLib 2.1.2, CartConvert -p 9.
        let e = earth();
        let near = |p: [f64; 3], q: [f64; 3]| assert!(distance(p, q) < 3e-9, "{p:?} {q:?}");
        near(
            e.ecef_from_deg_m(44.4, 33.3, 6000.0),
            [3_816_209.604_493_091, 3_737_108.550_254_264, 3_485_109.572_568_041],
        );
        near(e.ecef_from_deg_m(25.0, 60.0, 0.0), [2_897_560.783_099_765, 1_351_154.783_129_015, 5_500_477.133_938_639]);
    }

    #[test]
    fn the_normal_is_that_of_the_latitude() {
        let e = earth();
        for (lon, lat) in [(0.0, 0.0), (10.0, 45.0), (-170.0, -89.9), (20.0, 90.0)] {
            let from_point = e.normal_at(e.ecef_from_deg_m(lon, lat, 0.0));
            assert!(distance(from_point, Ellipsoid::normal_from_deg(lon, lat)) < 1e-15);
        }
    }

    #[test]
    fn centre_and_axes_have_an_answer() {
        for body in [earth(), Ellipsoid { a_m: 5.0, b_m: 5.0 }, Ellipsoid { a_m: 3.0, b_m: 9.0 }] {
            let shortest = body.a_m.min(body.b_m);
            let at = body.geodetic_from_ecef([0.0; 3]);
            assert!((at.height_m + shortest).abs() < 1e-9, "{at:?}");
            let tiny = body.geodetic_from_ecef([1e-30, 0.0, -1e-30]);
            assert!((tiny.height_m + shortest).abs() < 1e-9, "{tiny:?}");
            let above = body.geodetic_from_ecef([0.0, 0.0, body.b_m + 1.0]);
            assert_eq!(above.lat_rad, std::f64::consts::FRAC_PI_2);
            assert!((above.height_m - 1.0).abs() < 1e-8);
            let east = body.geodetic_from_ecef([0.0, body.a_m + 1.0, 0.0]);
            assert_eq!((east.lat_rad, east.lon_rad), (0.0, std::f64::consts::FRAC_PI_2));
            assert!((east.height_m - 1.0).abs() < 1e-8);
        }
    }

    proptest! {
        #[test]
        fn there_and_back(lon in -180.0..180.0f64, lat in -90.0..=90.0f64, height_m in -6.0e5..1e8f64,
                          flattening in -0.3..0.3f64) {
            let body = Ellipsoid { a_m: 6.4e6, b_m: 6.4e6 * (1.0 - flattening) };
            let point = body.ecef_from_deg_m(lon, lat, height_m);
            let back = body.geodetic_from_ecef(point);
            prop_assert!((back.height_m - height_m).abs() < 1e-7, "{:?}", back);
            prop_assert!(distance(body.ecef_m(back), point) < 1e-7);
        }

        #[test]
        fn any_point_is_reproduced(x in -7e6..7e6f64, y in -7e6..7e6f64, z in -7e6..7e6f64, shrink in -12.0..0.0f64) {
            let scale = 10f64.powf(shrink);
            let point = [x * scale, y * scale, z * scale];
            let back = earth().geodetic_from_ecef(point);
            prop_assert!(back.lat_rad.is_finite() && back.lat_rad.abs() <= std::f64::consts::FRAC_PI_2);
            prop_assert!(distance(earth().ecef_m(back), point) < 1e-7, "{:?} {:?}", point, back);
        }
    }
}
