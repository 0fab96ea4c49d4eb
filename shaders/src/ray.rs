//! A straight ray in geodetic terms, all lengths relative to its start: its
//! height above the ellipsoid and its crossings of meridians and parallels, exact, in plain f32.
//!
//! On a plane the same functions hold without curvature.

use crate::angle::{UNIT_RAD, sin_cos, sin_cos_lat, sin_cos_small};
use crate::planet::Planet;

/// A distance that no ray reaches, metres.
pub const FAR: f32 = 1.0e30;

/// A ray from a point of the relief.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ray {
    /// Start in fixed point.
    pub s: u32,
    /// Start in fixed point.
    pub t: u32,
    /// Height of the start, metres.
    pub height_m: f32,
    /// Unit direction at the start: eastwards.
    pub east: f32,
    /// Unit direction at the start: northwards.
    pub north: f32,
    /// Unit direction at the start: along the normal.
    pub up: f32,
    /// Sine of the start's latitude.
    pub sin_lat: f32,
    /// Cosine of the start's latitude.
    pub cos_lat: f32,
    /// sqrt(1 - e2 sin^2) at the start.
    pub w0: f32,
    /// Prime vertical radius N at the start, metres.
    pub n0_m: f32,
    /// N + height at the start, metres; [`FAR`] on a plane.
    pub r0_m: f32,
    /// Distance of the start from the polar axis, metres.
    pub rho0_m: f32,
    /// Direction away from the polar axis, in the start's meridian plane.
    pub out: f32,
    /// Direction along the polar axis.
    pub axial: f32,
    /// The ray moves north while `turn_m` + distance * `turn` is positive.
    pub turn_m: f32,
    /// See `turn_m`; 0 on a plane.
    pub turn: f32,
}

/// A meridian as a ray sees it: the ray is `rate` distance - `offset_m` metres east of its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meridian {
    /// Metres that the start lies west of the plane.
    pub offset_m: f32,
    /// Metres eastwards of each metre of the ray.
    pub rate: f32,
}

/// A parallel as a ray sees it: the ray is `north_m` + `rate` distance - `sin` bend metres north
/// of the cone of the parallel's normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallel {
    /// Metres that the start lies north.
    pub north_m: f32,
    /// Metres northwards of each metre of the ray.
    pub rate: f32,
    /// Sine of the parallel's latitude; 0 on a plane.
    pub sin: f32,
    /// Cosine of the parallel's latitude; 1 on a plane.
    pub cos: f32,
    /// Sum of the two factors of which `north_m` is the ray_difference, at the start, metres.
    pub sum_m: f32,
    /// e2 (N1 sin psi1 - N0 sin psi0), metres.
    pub shift_m: f32,
}

/// The angle of (x, y) in units, within 2e-7 rad; 0 for the origin.
#[must_use]
#[inline]
pub fn ray_heading(x: f32, y: f32) -> u32 {
    let [ax, ay] = [x.abs(), y.abs()];
    let long = ax.max(ay);
    if long == 0.0 {
        return 0;
    }
    // A ratio of at most tan(pi/8) after a turn by half a right angle.
    let short = ax.min(ay);
    let folded = short > 0.414_213_57 * long;
    let z = if folded { (short - long) / (short + long) } else { short / long };
    let z2 = z * z;
    let poly = z + z * z2 * (-3.333_295e-1 + z2 * (1.997_771_1e-1 + z2 * (-1.387_768_6e-1 + z2 * 8.053_744_6e-2)));
    let mut units = (poly * (1.0 / UNIT_RAD)) as i32 as u32;
    if folded {
        units = units.wrapping_add(0x2000_0000);
    }
    if ay > ax {
        units = 0x4000_0000u32.wrapping_sub(units);
    }
    if x < 0.0 {
        units = 0x8000_0000u32.wrapping_sub(units);
    }
    if y < 0.0 { units.wrapping_neg() } else { units }
}

/// A ray from (S, T) at a height along a unit direction (east, north, up).
///
/// At a pole the ray is told in the meridian that it runs along: there no longitude is crossed.
#[must_use]
#[inline]
pub fn ray_from(planet: &Planet, s: u32, t: u32, height_m: f32, direction: [f32; 3]) -> Ray {
    let [east, north, up] = direction;
    let mut ray = Ray { s, t, height_m, east, north, up, ..Ray::default() };
    if planet.plane != 0 {
        ray.r0_m = FAR;
        ray.turn_m = north;
        return ray;
    }
    [ray.sin_lat, ray.cos_lat] = sin_cos_lat(t);
    if ray.cos_lat == 0.0 {
        ray.s = s.wrapping_add(ray_heading(-north * ray.sin_lat, east));
        ray.east = 0.0;
        ray.north = -ray.sin_lat * (east * east + north * north).sqrt();
    }
    ray.w0 = (1.0 - planet.e2 * ray.sin_lat * ray.sin_lat).sqrt();
    ray.n0_m = planet.a_m / ray.w0;
    ray.r0_m = ray.n0_m + height_m;
    ray.rho0_m = ray.r0_m * ray.cos_lat;
    ray.out = up * ray.cos_lat - ray.north * ray.sin_lat;
    ray.axial = up * ray.sin_lat + ray.north * ray.cos_lat;
    ray.turn_m = ray.r0_m * ray.cos_lat * ray.north;
    ray.turn = ray.axial * up - ray.sin_lat;
    ray
}

/// What the distance from the polar axis gains on its tangent at the start, metres: the path's
/// bend in the meridian plane.
#[must_use]
#[inline]
pub fn ray_bend_m(planet: &Planet, ray: &Ray, at_m: f32) -> f32 {
    if planet.plane != 0 {
        return 0.0;
    }
    let [x, y] = [at_m * ray.out, at_m * ray.east];
    let [rx, square] = [ray.rho0_m + x, x * x + y * y];
    let sum = ((rx * rx + y * y).sqrt() + ray.rho0_m).max(1.0e-20);
    let d_rho = (2.0 * ray.rho0_m * x + square) / sum;
    (square - x * d_rho) / sum
}

/// Height above the ellipsoid at a distance, less the start's, metres. On Earth within 1.3 mm + 1e-6
/// of the distance up to 400 km.
#[must_use]
#[inline]
pub fn ray_rise_m(planet: &Planet, ray: &Ray, at_m: f32) -> f32 {
    if planet.plane != 0 {
        return at_m * ray.up;
    }
    let bend_m = ray_bend_m(planet, ray, at_m);
    let [x, n] = [at_m * ray.up + ray.cos_lat * bend_m, at_m * ray.north - ray.sin_lat * bend_m];
    let r0 = ray.r0_m;
    let mut up_m = x;
    let mut along_m = n;
    let mut d_n = 0.0;
    // The height is stationary in the latitude: one round is enough on a planet.
    let rounds = if planet.e2 == 0.0 { 0 } else { 1 + i32::from(planet.e2.abs() > 0.02) };
    for _ in 0..rounds {
        let radius = ((r0 + up_m) * (r0 + up_m) + along_m * along_m).sqrt();
        let [sin, cos] = [along_m / radius, (r0 + up_m) / radius];
        let d_sin = ray.cos_lat * sin - ray.sin_lat * sin * sin / (1.0 + cos);
        let [dn, shift] = ray_normal_shift_m(planet, ray, ray.sin_lat + d_sin, d_sin);
        d_n = dn;
        up_m = x + ray.sin_lat * shift;
        along_m = n + ray.cos_lat * shift;
    }
    let radius = ((r0 + up_m) * (r0 + up_m) + along_m * along_m).sqrt();
    (2.0 * r0 * up_m + up_m * up_m + along_m * along_m) / (radius + r0) - d_n
}

/// (N1 - N0, e2 (N1 sin psi1 - N0 sin psi0)), metres, for a latitude by its sine and the
/// difference of the sines.
#[must_use]
#[inline]
pub fn ray_normal_shift_m(planet: &Planet, ray: &Ray, sin1: f32, d_sin: f32) -> [f32; 2] {
    let w1 = (1.0 - planet.e2 * sin1 * sin1).sqrt();
    let d_n = planet.a_m * planet.e2 * d_sin * (sin1 + ray.sin_lat) / (ray.w0 * w1 * (ray.w0 + w1));
    [d_n, planet.e2 * ((ray.n0_m + d_n) * d_sin + d_n * ray.sin_lat)]
}

/// a - b of coordinates that do not wrap.
#[must_use]
#[inline]
pub fn ray_difference(a: u32, b: u32) -> f32 {
    if a >= b { (a - b) as f32 } else { -((b - a) as f32) }
}

/// The meridian S.
#[must_use]
#[inline]
pub fn ray_meridian(planet: &Planet, ray: &Ray, s: u32) -> Meridian {
    if planet.plane != 0 {
        return Meridian { offset_m: ray_difference(s, ray.s) * planet.unit_x_m, rate: ray.east };
    }
    let [sin, cos] = sin_cos(s.wrapping_sub(ray.s));
    Meridian { offset_m: ray.rho0_m * sin, rate: ray.east * cos - ray.out * sin }
}

/// Metres that a point of the ray lies east of a meridian's plane.
#[must_use]
#[inline]
pub fn ray_east_of_m(meridian: Meridian, at_m: f32) -> f32 {
    meridian.rate * at_m - meridian.offset_m
}

/// Distance at which the ray crosses a meridian ahead, metres; [`FAR`] if it never does.
#[must_use]
#[inline]
pub fn ray_meridian_at_m(ray: &Ray, meridian: Meridian) -> f32 {
    let sign = if ray.east > 0.0 { 1.0 } else { -1.0 };
    ray_line_at_m(sign * meridian.offset_m, sign * meridian.rate)
}

/// Distance at which something `ahead_m` metres ahead is reached at a rate; [`FAR`] if it is not
/// ahead or never reached.
#[must_use]
#[inline]
pub fn ray_line_at_m(ahead_m: f32, rate: f32) -> f32 {
    if ahead_m > 0.0 && rate > 0.0 && ahead_m < FAR * rate { ahead_m / rate } else { FAR }
}

/// The parallel T, within 90 degrees of the start.
#[must_use]
#[inline]
pub fn ray_parallel(planet: &Planet, ray: &Ray, t: u32) -> Parallel {
    let dt = ray_difference(t, ray.t);
    if planet.plane != 0 {
        return Parallel {
            north_m: -dt * planet.unit_y_m,
            rate: ray.north,
            sin: 0.0,
            cos: 1.0,
            sum_m: 0.0,
            shift_m: 0.0,
        };
    }
    let [sin1, cos1] = sin_cos_lat(t);
    let [half_sin, half_cos] = sin_cos_small(0.5 * UNIT_RAD * dt);
    let [sin_d, one_less_cos] = [2.0 * half_sin * half_cos, 2.0 * half_sin * half_sin];
    let d_sin = sin_d * ray.cos_lat - ray.sin_lat * one_less_cos;
    let [_, shift_m] = ray_normal_shift_m(planet, ray, sin1, d_sin);
    Parallel {
        north_m: cos1 * shift_m - ray.r0_m * sin_d,
        rate: ray.north - ray.north * one_less_cos - ray.up * sin_d,
        sin: sin1,
        cos: cos1,
        sum_m: cos1 * (ray.r0_m * ray.sin_lat + shift_m) + sin1 * ray.rho0_m,
        shift_m,
    }
}

/// Metres that a point of the ray with the given bend lies north of a parallel's cone.
#[must_use]
#[inline]
pub fn ray_north_of_m(parallel: Parallel, at_m: f32, bend_m: f32) -> f32 {
    parallel.north_m + parallel.rate * at_m - parallel.sin * bend_m
}

/// Distance at which the ray crosses a parallel northwards (or southwards), metres; [`FAR`] if it
/// never does. The cone's quadratic A t^2 + 2 B t + C, with B^2 - A C = sin^2 (a sum of squares
/// and products that do not cancel) and the branch chosen by the sense of the crossing.
#[must_use]
#[inline]
pub fn ray_parallel_at_m(planet: &Planet, ray: &Ray, p: Parallel, northward: bool) -> f32 {
    let sign = if northward { 1.0 } else { -1.0 };
    if planet.plane != 0 {
        return ray_line_at_m(-sign * p.north_m, sign * p.rate);
    }
    let q = p.cos * (ray.r0_m * ray.north - ray.out * p.shift_m);
    let c = p.north_m * p.sum_m;
    let d = q * q + ray.east * ray.east * c;
    if d < 0.0 {
        return FAR;
    }
    let root = sign * p.sin * d.sqrt();
    let b = 0.5 * (p.sum_m * p.rate + p.north_m * (p.cos * ray.axial + p.sin * ray.out));
    // Of the two forms the one that adds.
    let [over, under] =
        if b * root >= 0.0 { [-c, b + root] } else { [root - b, (ray.axial - p.sin) * (ray.axial + p.sin)] };
    if over.abs() >= FAR * under.abs() {
        return FAR;
    }
    let at_m = over / under;
    // The other half of the double cone has the latitude's sign reversed.
    let z = ray.r0_m * ray.sin_lat + p.shift_m + at_m * ray.axial;
    if at_m > 0.0 && z * p.sin >= 0.0 { at_m } else { FAR }
}

/// Whether the ray moves north at a distance. A straight line's latitude turns once at most.
#[must_use]
#[inline]
pub fn ray_moves_north(ray: &Ray, at_m: f32) -> bool {
    let rate = ray.turn_m + ray.turn * at_m;
    if rate == 0.0 { ray.turn > 0.0 } else { rate > 0.0 }
}

#[cfg(test)]
mod tests;
