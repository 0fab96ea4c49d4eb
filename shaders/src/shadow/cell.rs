//! The bilinear patch of a cell against a ray.

use super::square::{Square, square_shift};
use crate::planet::Planet;
use crate::ray::{
    Meridian, Parallel, Ray, ray_bend_m, ray_east_of_m, ray_meridian, ray_north_of_m, ray_parallel, ray_rise_m,
};

/// Rows beside a pole where a straight way is bent on the map.
const POLAR_ROWS: u32 = 8;
/// Parts of the way through one of their cells.
const POLAR_PARTS: u32 = 8;

/// Rounds of the search for the steepest slope; each squares what is lacking.
const CELL_ROUNDS: u32 = 6;

/// A cell's borders as a ray sees them, and the heights of its nodes.
#[derive(Clone, Copy, Debug)]
pub struct CellPatch {
    west: Meridian,
    east: Meridian,
    south: Parallel,
    north: Parallel,
    /// South-west, south-east, north-west, north-east, metres above the ray's start.
    corners_m: [f32; 4],
    /// Height of the patch at the ray's start, which it does not shade; 0 in other cells.
    base_m: f32,
    /// Parts in which the ray's way is as good as straight on the map.
    parts: u32,
}

/// The patch of a cell with corners in metres. `first`: the ray starts on it.
#[must_use]
#[inline]
pub fn cell_patch(planet: &Planet, ray: &Ray, cell: Square, corners_m: [f32; 4], first: bool) -> CellPatch {
    let shift = square_shift(planet, cell.level);
    let mut patch = CellPatch {
        west: ray_meridian(planet, ray, cell.x << shift),
        east: ray_meridian(planet, ray, (cell.x + 1) << shift),
        south: ray_parallel(planet, ray, cell.y << shift),
        north: ray_parallel(planet, ray, (cell.y + 1) << shift),
        corners_m: corners_m.map(|m| m - ray.height_m),
        base_m: 0.0,
        parts: cell_parts(planet, cell),
    };
    if first {
        patch.base_m = cell_above_m(planet, ray, &patch, 0.0);
    }
    patch
}

/// Metres by which the patch is above the ray at a distance.
#[must_use]
#[inline]
pub fn cell_above_m(planet: &Planet, ray: &Ray, patch: &CellPatch, at_m: f32) -> f32 {
    let bend_m = ray_bend_m(planet, ray, at_m);
    let u = cell_share(ray_east_of_m(patch.west, at_m), ray_east_of_m(patch.east, at_m));
    let v = cell_share(ray_north_of_m(patch.south, at_m, bend_m), ray_north_of_m(patch.north, at_m, bend_m));
    let [h00, h10, h01, h11] = patch.corners_m;
    let [south, north] = [h00 + (h10 - h00) * u, h01 + (h11 - h01) * u];
    (south + (north - south) * v - patch.base_m) - ray_rise_m(planet, ray, at_m)
}

/// Share of the way from one border to the next, from the distances to both.
#[inline]
fn cell_share(from_m: f32, to_m: f32) -> f32 {
    let width_m = from_m - to_m;
    if width_m > 0.0 { (from_m / width_m).clamp(0.0, 1.0) } else { 0.0 }
}

fn cell_parts(planet: &Planet, cell: Square) -> u32 {
    let from_pole = cell.y.min((1 << (planet.m - cell.level)) - 1 - cell.y);
    if planet.plane == 0 && from_pole < POLAR_ROWS { POLAR_PARTS } else { 1 }
}

/// The steepest slope (metres above the ray, a metre of distance) at which the patch stands above
/// the ray between two distances, or `best` if that is steeper.
#[must_use]
#[inline]
pub fn cell_slope(planet: &Planet, ray: &Ray, patch: &CellPatch, from_m: f32, to_m: f32, best: f32) -> f32 {
    let part_m = (to_m - from_m) / patch.parts as f32;
    let mut slope = best;
    let mut ends = [from_m, cell_above_m(planet, ray, patch, from_m)];
    for part in 1..=patch.parts {
        let end_m = if part == patch.parts { to_m } else { from_m + part as f32 * part_m };
        let middle = cell_above_m(planet, ray, patch, ends[0] + 0.5 * (end_m - ends[0]));
        let end = cell_above_m(planet, ray, patch, end_m);
        slope = part_slope([ends[0], end_m], [ends[1], middle, end], slope);
        ends = [end_m, end];
    }
    slope
}

/// [`cell_slope`] from the heights above the ray at both ends and in the middle. Along the ray the
/// difference is a quadratic: on a plane exactly, on a body but for terms of the third order. Its
/// ratio to the distance is raised by Dinkelbach's method.
#[inline]
fn part_slope([from_m, to_m]: [f32; 2], [f0, f1, f2]: [f32; 3], best: f32) -> f32 {
    let length_m = to_m - from_m;
    // f0 + p x + q x^2 for x in 0..=1.
    let p = 4.0 * f1 - 3.0 * f0 - f2;
    let q = 2.0 * (f0 + f2) - 4.0 * f1;
    let mut slope = best.max(f0 / from_m).max(f2 / to_m);
    for _ in 0..CELL_ROUNDS {
        let rise = p - slope * length_m;
        let inside = q < 0.0 && rise > 0.0 && rise < -2.0 * q;
        let x = if inside { -0.5 * rise / q } else { 0.0 };
        let steeper = (f0 + x * (p + x * q)) / (from_m + x * length_m);
        if !inside || steeper <= slope {
            break;
        }
        slope = steeper;
    }
    slope
}
