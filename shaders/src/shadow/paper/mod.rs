//! The shadow kernel of paper 001 as printed (Algo 1 to 3), on a plane over a flat sea: the
//! baseline. Twin of `wgsl/lib/shadow_paper.wgsl`.
//!
//! The map is a texture: the height of texel (i, j) holds at its centre, (i + 1/2, j + 1/2) in
//! texels. What the paper gets wrong is kept: extremes sampled at texel corners do not bound the
//! surface, and the surface is compared in the middle of a texel's crossing only.
//!
//! As printed the greatest height of a texel, too, is compared where the ray leaves it, at its
//! highest there. A rising ray then passes most coarse texels untested, which the paper's pictures
//! exclude; [`Reading::Meant`] compares it where the ray enters.

mod map;

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::exact::Sunlight;
use super::mask::WindowCounts;
pub use map::{PaperMap, paper_level_start};

/// The coarsest anisotropy that a texture unit makes up for.
pub const ANISOTROPY_MOST: f32 = 16.0;
/// A component of a direction that counts as nothing.
const EPSILON: f32 = 1.0e-7;
/// Steps after which a ray counts as lit.
const STEPS_MAX: u32 = 1 << 16;

/// Where a texel's greatest height is compared with the ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// At the exit, as Algo 3 says.
    Printed = 0,
    /// At the entry.
    Meant = 1,
}

/// What the kernel is told: `struct ShadowPaperMap` of `wgsl/lib/shadow_paper.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ShadowPaperMap {
    /// Unit vector to the sun (east, north, up); fourth: zero.
    pub sun: [f32; 4],
    /// Metres between texels.
    pub spacing_m: [f32; 2],
    /// 2^m x 2^m texels.
    pub m: u32,
    /// Level of detail.
    pub q: u32,
    /// A [`Reading`].
    pub reading: u32,
    /// Zero.
    pub padding: [u32; 3],
}

/// Where a ray leaves a texel, and the texel it comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Crossing {
    distance_m: f32,
    column: i32,
    row: i32,
}

impl PaperMap {
    /// Algo 3: the light at a point in texels of level 0, `height_m` high, at level of detail q.
    /// `sun` is a unit vector (east, north, up).
    #[must_use]
    pub fn paper_shadow(&self, at: [f32; 2], height_m: f32, q: u32, sun: [f32; 3], reading: Reading) -> Sunlight {
        let mut light = Sunlight { visible: 1.0, ..Sunlight::default() };
        let flat = (sun[0] * sun[0] + sun[1] * sun[1]).sqrt();
        // Texels of level 0 a metre on the ground, and metres up.
        let step = [sun[0] / (flat * self.spacing_m[0]), sun[1] / (flat * self.spacing_m[1])];
        if flat <= EPSILON || (step[0].abs() <= EPSILON && step[1].abs() <= EPSILON) {
            return light;
        }
        let climb = sun[2] / flat;
        let (coarsest, side) = (self.m - 1, 1i32 << (self.m - q));
        let scale = 1.0 / (1u32 << q) as f32;
        let start = [(at[0] * scale).floor() as i32, (at[1] * scale).floor() as i32];
        let first = paper_crossing(at, step, q, start, 0.0);
        let mut distance_m = first.distance_m;
        // The texel of level q.
        let mut texel = [first.column, first.row];
        let mut level = q;
        while texel[0] >= 0 && texel[0] < side && texel[1] >= 0 && texel[1] < side && light.counts.steps < STEPS_MAX {
            light.counts.steps += 1;
            let shift = level - q;
            let here = [texel[0] >> shift, texel[1] >> shift];
            let out = paper_crossing(at, step, level, here, distance_m);
            let ray_m = height_m + climb * out.distance_m;
            let mut below = false;
            if level > q {
                let [least_m, greatest_m] = self.paper_extremes_m(level - 1, here[0], here[1]);
                light.counts.extremes += 1;
                if ray_m <= least_m {
                    light.visible = 0.0;
                    return light;
                }
                let test_m = if reading == Reading::Meant { distance_m } else { out.distance_m };
                below = height_m + climb * test_m <= greatest_m;
            } else {
                let middle_m = 0.5 * (distance_m + out.distance_m);
                let [x, y] = [at[0] + step[0] * middle_m, at[1] + step[1] * middle_m];
                light.counts.heights += 4;
                if height_m + climb * middle_m <= self.paper_bilinear_m(q, x, y) {
                    light.visible = 0.0;
                    return light;
                }
            }
            if below {
                level -= 1;
                continue;
            }
            let end = [at[0] + step[0] * out.distance_m, at[1] + step[1] * out.distance_m];
            texel = [
                paper_texel(end[0] * scale, here[0], out.column, shift),
                paper_texel(end[1] * scale, here[1], out.row, shift),
            ];
            distance_m = out.distance_m;
            level = coarsest;
        }
        light
    }
}

impl PaperMap {
    /// The light of every texel of H_0 at level of detail q, 255 lit or 0, south row first.
    #[must_use]
    pub fn paper_mask(&self, q: u32, sun: [f32; 3], reading: Reading) -> (Vec<u8>, WindowCounts) {
        let side = 1usize << self.m;
        let mut mask = vec![0; side * side];
        let counts = mask
            .par_chunks_mut(side)
            .enumerate()
            .map(|(j, out)| {
                let mut counts = WindowCounts::default();
                for (i, out) in out.iter_mut().enumerate() {
                    let at = [i as f32 + 0.5, j as f32 + 0.5];
                    let light = self.paper_shadow(at, self.paper_bilinear_m(q, at[0], at[1]), q, sun, reading);
                    *out = (light.visible * 255.0 + 0.5) as u8;
                    counts = counts.with(&light);
                }
                counts
            })
            .reduce(WindowCounts::default, WindowCounts::plus);
        (mask, counts)
    }
}

/// Algo 2: the crossing of texel (column, row) of a level by the ray that starts at `at` and moves
/// `step` texels of level 0 a metre.
fn paper_crossing(at: [f32; 2], step: [f32; 2], level: u32, [column, row]: [i32; 2], from_m: f32) -> Crossing {
    let size = (1u32 << level) as f32;
    let corner = [(column + i32::from(step[0] >= 0.0)) as f32 * size, (row + i32::from(step[1] >= 0.0)) as f32 * size];
    let [dx, dy] = [if step[0] >= 0.0 { 1 } else { -1 }, if step[1] >= 0.0 { 1 } else { -1 }];
    if step[0].abs() <= EPSILON {
        return Crossing { distance_m: ((corner[1] - at[1]) / step[1]).max(from_m), column, row: row + dy };
    }
    if step[1].abs() <= EPSILON {
        return Crossing { distance_m: ((corner[0] - at[0]) / step[0]).max(from_m), column: column + dx, row };
    }
    let [ex, ey] = [(corner[0] - at[0]) / step[0], (corner[1] - at[1]) / step[1]];
    Crossing {
        distance_m: ex.min(ey).max(from_m),
        column: if ex <= ey { column + dx } else { column },
        row: if ey <= ex { row + dy } else { row },
    }
}

/// Index of level q after a step from texel `here` to `next` of a level `shift` coarser: at the
/// border that was crossed, or where the ray is.
fn paper_texel(place: f32, here: i32, next: i32, shift: u32) -> i32 {
    if next > here {
        next << shift
    } else if next < here {
        ((next + 1) << shift) - 1
    } else {
        (place.floor() as i32).clamp(here << shift, ((here + 1) << shift) - 1)
    }
}

/// Algo 1: the level of detail of a pixel from the derivatives of its texture coordinates by X and
/// by Y, in texels of level 0; at most `coarsest`.
#[must_use]
pub fn paper_detail(by_x: [f32; 2], by_y: [f32; 2], coarsest: u32) -> u32 {
    let a = by_x[0] * by_x[0] + by_x[1] * by_x[1];
    let b = by_y[0] * by_y[0] + by_y[1] * by_y[1];
    let [long, short] = [a.max(b), a.min(b)];
    if long <= 1.0 {
        return 0;
    }
    let anisotropy =
        if short * ANISOTROPY_MOST * ANISOTROPY_MOST > long { (long / short).sqrt().ceil() } else { ANISOTROPY_MOST };
    let level = (0.5 * long.log2() - anisotropy.min(ANISOTROPY_MOST).log2()).floor();
    (level.max(0.0) as u32).min(coarsest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(azimuth_deg: f32, elevation_deg: f32) -> [f32; 3] {
        let ((sa, ca), (se, ce)) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
        [ce * sa, ce * ca, se]
    }

    #[test]
    fn levels_lie_one_after_the_other() {
        assert_eq!([0, 1, 2, 3].map(|k| paper_level_start(3, k)), [0, 64, 80, 84]);
    }

    #[test]
    fn detail_is_algo_1() {
        assert_eq!(paper_detail([1.0, 0.0], [0.0, 1.0], 9), 0);
        assert_eq!(paper_detail([8.0, 0.0], [0.0, 8.0], 9), 3);
        // Four times as long as wide: two levels finer than its length.
        assert_eq!(paper_detail([32.0, 0.0], [0.0, 8.0], 9), 3);
        assert_eq!(paper_detail([1024.0, 0.0], [0.0, 0.001], 9), 6);
        assert_eq!(paper_detail([1e6, 0.0], [0.0, 1e6], 9), 9);
    }

    #[test]
    fn a_wall_throws_a_shadow_of_its_length() {
        let side = 64;
        let heights = (0..side * side).map(|k| if (40..45).contains(&(k % side)) { 100.0 } else { 0.0 }).collect();
        let map = PaperMap::new(6, [10.0, 10.0], heights);
        // 100 m at 30 degrees: 173 m.
        let light =
            |column: f32| map.paper_shadow([column + 0.5, 20.5], 0.0, 0, sun(90.0, 30.0), Reading::Meant).visible;
        assert_eq!([light(10.0), light(21.0), light(24.0), light(38.0)], [1.0, 1.0, 0.0, 0.0]);
        assert_eq!([light(46.0), light(60.0)], [1.0, 1.0]);
        // As printed the wall is passed over from far off.
        let printed = map.paper_shadow([24.5, 20.5], 0.0, 0, sun(90.0, 30.0), Reading::Printed);
        assert_eq!(printed.visible, 1.0);
        assert_eq!(map.paper_shadow([10.5, 20.5], 0.0, 0, [0.0, 0.0, 1.0], Reading::Meant).visible, 1.0);
    }

    #[test]
    fn extremes_of_corners_lose_a_spike() {
        // The weakness that the exact kernel does not have: a spike of one texel is averaged away.
        let side = 64;
        let heights = (0..side * side).map(|k| if k == 20 * side + 40 { 100.0 } else { 0.0 }).collect();
        let map = PaperMap::new(6, [10.0, 10.0], heights);
        assert_eq!(map.paper_extremes_m(0, 20, 10), [0.0, 25.0]);
    }
}
