//! Squares of the map and how a ray leaves them: the stepping of Algo 2 of paper 001, on a curved
//! body and on any level. Every step crosses a border for good, so no ray stalls.

use crate::planet::Planet;
use crate::ray::{
    FAR, Ray, ray_bend_m, ray_difference, ray_east_of_m, ray_meridian, ray_meridian_at_m, ray_moves_north,
    ray_north_of_m, ray_parallel, ray_parallel_at_m,
};

/// 2^level x 2^level cells of level 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Square {
    /// The level.
    pub level: u32,
    /// Column of the level.
    pub x: u32,
    /// Row of the level.
    pub y: u32,
}

/// Where a ray leaves a square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// Distance, metres; not before the entry.
    pub at_m: f32,
    /// Columns to step: -1, 0 or 1.
    pub dx: i32,
    /// Rows to step: -1, 0 or 1.
    pub dy: i32,
}

/// Units along a square's side, as a shift.
#[must_use]
#[inline]
pub fn square_shift(planet: &Planet, level: u32) -> u32 {
    31 - planet.m + level
}

/// Columns of a level; rows are 2^(m - level).
#[must_use]
#[inline]
pub fn square_columns(planet: &Planet, level: u32) -> u32 {
    1 << (planet.m + 1 - planet.plane - level)
}

/// The square of a level that a ray enters first; on a border the one ahead. None for a ray that
/// leaves a plane at once.
#[must_use]
#[inline]
pub fn square_first(planet: &Planet, ray: &Ray, level: u32) -> Option<Square> {
    let shift = square_shift(planet, level);
    let [west, south] = [ray.east < 0.0, !ray_moves_north(ray, 0.0)];
    let [columns, rows] = [square_columns(planet, level), 1 << (planet.m - level)];
    if planet.plane != 0 {
        let off_x = if west { ray.s == 0 } else { ray.east > 0.0 && ray.s >> shift == columns };
        let off_y = if south { ray.north < 0.0 && ray.t == 0 } else { ray.t >> shift == rows };
        if off_x || off_y {
            return None;
        }
    }
    let x = ray.s.wrapping_sub(u32::from(west)) >> shift;
    let y = (ray.t - u32::from(south && ray.t > 0)) >> shift;
    Some(Square { level, x: x.min(columns - 1), y: y.min(rows - 1) })
}

/// The way out of a square for a ray that entered it at a distance. `over_pole`: it has passed
/// over a pole.
#[must_use]
#[inline]
pub fn square_exit(planet: &Planet, ray: &Ray, square: Square, at_m: f32, over_pole: bool) -> Exit {
    let shift = square_shift(planet, square.level);
    let mut x_at_m = FAR;
    if ray.east != 0.0 {
        let border = square.x + u32::from(ray.east > 0.0);
        x_at_m = ray_meridian_at_m(ray, ray_meridian(planet, ray, border << shift)).max(at_m);
    }
    // The turn is behind once the pole is.
    let north = if over_pole { ray.turn > 0.0 } else { ray_moves_north(ray, at_m) };
    let [south_t, north_t] = [square.y << shift, (square.y + 1) << shift];
    let mut ahead = north;
    let mut y_at_m =
        ray_parallel_at_m(planet, ray, ray_parallel(planet, ray, if north { north_t } else { south_t }), north);
    if y_at_m == FAR && ray.turn != 0.0 && north != (ray.turn > 0.0) {
        ahead = !north;
        y_at_m =
            ray_parallel_at_m(planet, ray, ray_parallel(planet, ray, if north { south_t } else { north_t }), !north);
    }
    y_at_m = y_at_m.max(at_m);
    let dx = if ray.east > 0.0 { 1 } else { -1 };
    let dy = if ahead { 1 } else { -1 };
    if x_at_m < y_at_m {
        Exit { at_m: x_at_m, dx, dy: 0 }
    } else if y_at_m < x_at_m {
        Exit { at_m: y_at_m, dx: 0, dy }
    } else if x_at_m < FAR {
        Exit { at_m: x_at_m, dx, dy }
    } else {
        Exit { at_m: FAR, dx: 0, dy: 0 }
    }
}

/// The quarter of a square, one level finer, in which the ray is at a distance. A ray that keeps to
/// its meridian is told by that: at a pole it is at all of them.
#[must_use]
#[inline]
pub fn square_child(planet: &Planet, ray: &Ray, square: Square, at_m: f32, over_pole: bool) -> Square {
    let level = square.level - 1;
    let shift = square_shift(planet, level);
    let [x, y] = [2 * square.x, 2 * square.y];
    let kept = (if over_pole { ray.s ^ (1 << 31) } else { ray.s }) >> shift;
    let east = if ray.east == 0.0 {
        kept > x
    } else {
        ray_east_of_m(ray_meridian(planet, ray, (x + 1) << shift), at_m) >= 0.0
    };
    let north = ray_north_of_m(ray_parallel(planet, ray, (y + 1) << shift), at_m, ray_bend_m(planet, ray, at_m)) >= 0.0;
    Square { level, x: x + u32::from(east), y: y + u32::from(north) }
}

/// A hundredth of a cell's side of a level, metres: the relief nearer than this shades nothing.
#[must_use]
#[inline]
pub fn shadow_near_m(planet: &Planet, level: u32) -> f32 {
    let units = ray_difference(1 << square_shift(planet, level), 0);
    let side_m = if planet.plane != 0 {
        units * planet.unit_x_m.min(planet.unit_y_m)
    } else {
        units * crate::angle::UNIT_RAD * planet.a_m
    };
    0.01 * side_m
}

/// The square of the next coarser level.
#[must_use]
#[inline]
pub fn square_parent(square: Square) -> Square {
    Square { level: square.level + 1, x: square.x >> 1, y: square.y >> 1 }
}

/// The square beside; over a pole the one in the same row half a turn on. None off a plane.
#[must_use]
#[inline]
pub fn square_beside(planet: &Planet, square: Square, dx: i32, dy: i32) -> Option<Square> {
    let columns = square_columns(planet, square.level);
    let rows = 1 << (planet.m - square.level);
    let x = square.x.wrapping_add_signed(dx);
    let y = square.y.wrapping_add_signed(dy);
    if planet.plane != 0 {
        return (x < columns && y < rows).then_some(Square { level: square.level, x, y });
    }
    let turn = if y < rows { 0 } else { columns >> 1 };
    Some(Square { level: square.level, x: (x ^ turn) & (columns - 1), y: if y < rows { y } else { square.y } })
}
