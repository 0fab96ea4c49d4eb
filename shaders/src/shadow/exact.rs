//! One ray from the relief to the sun: paper 001's Algo 3 made right.
//!
//! A square whose greatest height stays below the ray is skipped, one whose least height is above
//! it ends the ray; otherwise its quarter is entered, and in a cell of the wanted level the
//! bilinear patch is solved. After a skip the level goes up by one.

use super::Counts;
use super::cell::{cell_patch, cell_slope};
use super::square::{shadow_near_m, square_beside, square_child, square_exit, square_first, square_parent};
use super::sun::{disk_slopes, visible_part};
use crate::planet::Planet;
use crate::ray::{FAR, Ray, ray_from, ray_line_at_m, ray_rise_m};

/// Squares after which a ray counts as lit. Only a ray past a pole at the finest levels, through
/// slivers of a millimetre, comes near.
pub const STEPS_MAX: u32 = 1 << 20;

/// Heights and bounds as a ray fetches them.
pub trait Relief {
    /// (least, greatest) height of S_0 in metres over a square of `level` + 1, column x and row y;
    /// None where that level is not at hand.
    fn extremes_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 2]>;

    /// Heights of a cell's nodes in metres, south-west, south-east, north-west, north-east; None
    /// where that level is not at hand.
    fn corners_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 4]>;
}

/// How much of the sun a point sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sunlight {
    /// Visible part of the disk, 0 to 1; 0 or 1 with a hard edge.
    pub visible: f32,
    /// What it cost.
    pub counts: Counts,
}

/// The sunlight at (S, T, height). The relief is that of `level` or finer ones' bounds; `height_m`
/// is the height of the same level's surface. `sun` is a unit vector (east, north, up) at the
/// point; `disk_rad` its radius, 0 for a hard edge.
pub fn shadow_exact<R: Relief>(
    planet: &Planet,
    relief: &mut R,
    [s, t]: [u32; 2],
    height_m: f32,
    level: u32,
    sun: [f32; 3],
    disk_rad: f32,
) -> Sunlight {
    let ray = ray_from(planet, s, t, height_m, sun);
    let [least, most] = disk_slopes(sun, disk_rad);
    let mut counts = Counts::default();
    let slope = shadow_trace(planet, relief, &ray, level, [least, most], &mut counts);
    Sunlight { visible: visible_part(slope, sun, disk_rad), counts }
}

/// The steepest slope at which the relief stands above the ray, at least `least`; the search ends
/// once it is above `most`.
pub fn shadow_trace<R: Relief>(
    planet: &Planet,
    relief: &mut R,
    ray: &Ray,
    level: u32,
    [least, most]: [f32; 2],
    counts: &mut Counts,
) -> f32 {
    let top = planet.root_level + 1;
    let near_m = shadow_near_m(planet, level);
    let high_m = planet.max_m - ray.height_m;
    let end_m = ray_end_m(planet, ray, high_m, least);
    if ray_buried(planet, ray, most) {
        return FAR;
    }
    let Some(mut square) = square_first(planet, ray, level) else { return least };
    let mut leaf = true;
    let mut first = true;
    let mut over_pole = false;
    let mut at_m = 0.0;
    let mut rise_m = 0.0;
    let mut slope = least;
    for _ in 0..STEPS_MAX {
        if square.level > top {
            break;
        }
        counts.steps += 1;
        let mut exit = square_exit(planet, ray, square, at_m, over_pole);
        exit.at_m = exit.at_m.min(end_m).max(at_m);
        let out_rise_m = ray_rise_m(planet, ray, exit.at_m);
        if leaf {
            let Some(corners_m) = relief.corners_m(square.level, square.x, square.y) else {
                square = square_parent(square);
                leaf = first;
                continue;
            };
            counts.heights += 4;
            if exit.at_m >= near_m {
                let patch = cell_patch(planet, ray, square, corners_m, first);
                slope = cell_slope(planet, ray, &patch, at_m.max(near_m), exit.at_m, slope);
                if slope > most {
                    return slope;
                }
            }
            first = false;
        } else {
            let Some([min_m, max_m]) = relief.extremes_m(square.level - 1, square.x, square.y) else {
                leaf = true;
                continue;
            };
            counts.extremes += 1;
            let [above_m, below_m] = [max_m - ray.height_m, min_m - ray.height_m];
            if above_m > ray_lowest_m(planet, ray, [at_m, exit.at_m], [rise_m, out_rise_m], slope) {
                if below_m > out_rise_m + most * exit.at_m || (below_m > rise_m + most * at_m && at_m >= near_m) {
                    return FAR;
                }
                square = square_child(planet, ray, square, at_m, over_pole);
                leaf = square.level == level;
                continue;
            }
        }
        // Above all relief and rising.
        if out_rise_m + slope * exit.at_m >= high_m && exit.at_m >= ray_lowest_at_m(ray, slope) {
            break;
        }
        at_m = exit.at_m;
        rise_m = out_rise_m;
        let Some(next) = square_beside(planet, square, exit.dx, exit.dy) else { break };
        over_pole |= exit.dy != 0 && next.y == square.y;
        let inside = next.x >> 1 == square.x >> 1 && next.y >> 1 == square.y >> 1;
        if inside || next.level == top {
            square = next;
        } else {
            square = square_parent(next);
            leaf = false;
        }
    }
    slope
}

/// Distance at which the ray, raised by a slope, is lowest; metres.
#[inline]
fn ray_lowest_at_m(ray: &Ray, slope: f32) -> f32 {
    -ray.r0_m * (ray.up + slope)
}

/// Least rise of the ray, raised by a slope, between two distances at which its rises are known:
/// it falls until it is lowest, then climbs.
#[inline]
fn ray_lowest_m(planet: &Planet, ray: &Ray, at_m: [f32; 2], rise_m: [f32; 2], slope: f32) -> f32 {
    let low_at_m = ray_lowest_at_m(ray, slope);
    if at_m[0] >= low_at_m {
        rise_m[0] + slope * at_m[0]
    } else if at_m[1] <= low_at_m {
        rise_m[1] + slope * at_m[1]
    } else {
        ray_rise_m(planet, ray, low_at_m) + slope * low_at_m
    }
}

/// Whether the ray, raised by a slope, passes below all relief of the body: by night it does, and
/// nothing need be fetched. A plane may be left before.
#[inline]
fn ray_buried(planet: &Planet, ray: &Ray, slope: f32) -> bool {
    let low_at_m = ray_lowest_at_m(ray, slope);
    if planet.plane != 0 || low_at_m <= 0.0 {
        return false;
    }
    // Short of the centre, where no height is told.
    let at_m = low_at_m.min(0.5 * ray.r0_m);
    ray_rise_m(planet, ray, at_m) + slope * at_m < planet.min_m - ray.height_m
}

/// A distance beyond which the ray, raised by a slope, is above all relief.
#[inline]
fn ray_end_m(planet: &Planet, ray: &Ray, high_m: f32, slope: f32) -> f32 {
    let up = ray.up + slope;
    // A little more than needed: the radius of curvature is not the same everywhere.
    let climb_m = 1.05 * high_m.max(0.0) + 1.0;
    if planet.plane != 0 {
        return ray_line_at_m(climb_m, up);
    }
    let fall_m = -ray.r0_m * up;
    let root_m = (fall_m * fall_m + (2.0 * ray.r0_m + climb_m) * climb_m).sqrt();
    let near_m = if up > 0.0 { (2.0 * ray.r0_m + climb_m) * climb_m / (root_m - fall_m) } else { fall_m + root_m };
    (1.1 + planet.e2.abs()) * near_m
}
