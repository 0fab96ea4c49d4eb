//! Two overlays that show what a picture is made of: the pages it takes heights from, and the error
//! that is really drawn. Twin of `wgsl/lib/shade_overlay.wgsl`.
//!
//! The drawn height needs no place of its own in the targets: it is the pixel's point above the
//! ellipsoid, and so holds what a flat triangle loses to the planet's curve. Heights blended over
//! the triangle would not.

use super::ground::{detail, finest_page};
use super::light::mix;
use crate::angle::{sin_cos, sin_cos_lat};
use crate::pages::{Pages, SLOT_MASK};
use crate::planet::{Planet, View};
use crate::position::camera_relative_m;

/// Linear light; each level's next but six has its colour again. Told apart by the colour-blind
/// (Okabe and Ito, 2008).
const PAGE_COLOURS: [[f32; 3]; 7] = [
    [0.03, 0.36, 0.78],
    [0.791, 0.347, 0.0],
    [0.0, 0.342, 0.171],
    [0.604, 0.191, 0.386],
    [0.871, 0.776, 0.054],
    [0.0, 0.168, 0.445],
    [0.665, 0.112, 0.0],
];

/// Linear light, from no error over half the threshold, the threshold itself and one and a half to
/// twice the threshold. Blue and red stay apart for the colour-blind, and both darken away from
/// the threshold.
const ERROR_COLOURS: [[f32; 3]; 5] =
    [[0.012, 0.062, 0.33], [0.2, 0.46, 0.8], [0.93, 0.93, 0.93], [0.87, 0.26, 0.11], [0.32, 0.002, 0.012]];

/// The ground between stripes, linear light.
const STRIPE: [f32; 3] = [0.03, 0.03, 0.035];

/// How far the drawn surface is from the true one at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnError {
    /// Difference of the heights times the focal length over the distance, pixels.
    pub px: f32,
    /// Level of the surface that counts as the true one: 0 where its page is at hand.
    pub level: u32,
}

/// Linear light for a page of a level, column and row: neighbours differ.
#[must_use]
pub fn page_colour(level: u32, x: u32, y: u32) -> [f32; 3] {
    let bright = 1.0 - 0.4 * ((x + y) & 1) as f32;
    let pale = 0.08 * (y & 1) as f32;
    mix(PAGE_COLOURS[(level % 7) as usize], [1.0; 3], pale).map(|c| c * bright)
}

/// Linear light for an error, as a share of the threshold: blue below it, white at it, red above.
#[must_use]
pub fn error_colour(share: f32) -> [f32; 3] {
    let at = (share * 2.0).clamp(0.0, 4.0);
    let k = (at as usize).min(3);
    mix(ERROR_COLOURS[k], ERROR_COLOURS[k + 1], at - k as f32)
}

/// Slanting stripes over a picture: marks what is not the page that was wanted.
#[must_use]
pub fn striped(colour: [f32; 3], [column, row]: [u32; 2]) -> [f32; 3] {
    if (column + row) % 12 < 4 { mix(colour, STRIPE, 0.72) } else { colour }
}

/// A colour with a share of the ground's relief: its light beside that on level ground, so that it
/// reads as well by night.
#[must_use]
pub fn in_relief(colour: [f32; 3], light: [f32; 3], level_light: [f32; 3], share: f32) -> [f32; 3] {
    let bright = |c: [f32; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    let relief = (bright(light) / bright(level_light).max(1e-4)).clamp(0.1, 1.9);
    colour.map(|c| c * (1.0 + share * (relief - 1.0)))
}

/// The ground's upward unit normal without its relief, in the camera's frame.
fn up_at(planet: &Planet, view: &View, s: u32, t: u32) -> [f32; 3] {
    if planet.plane != 0 {
        return [0.0, 0.0, 1.0];
    }
    let [sin_lon, cos_lon] = sin_cos(s.wrapping_sub(view.camera_s));
    let [sin_lat, cos_lat] = sin_cos_lat(t);
    [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat]
}

/// The error at a pixel that shows (S, T) and whose drawn point lies at `point_m` from the camera, in
/// its frame.
///
/// Asked for is the page one level finer than a pixel: from far away S_0 is more pages than an atlas
/// holds.
#[must_use]
pub fn drawn_error(pages: &Pages<'_>, view: &View, [s, t]: [u32; 2], point_m: [f32; 3], distance_m: f32) -> DrawnError {
    let asked = (detail(pages.planet, view, distance_m) as u32).max(1) - 1;
    let first = pages.place(asked, s, t);
    pages.ask(asked, first.x, first.y);
    let level = finest_page(pages, 0, s, t);
    let at = pages.place(level, s, t);
    let page = pages.find(level, at.x, at.y);
    let true_m = pages.bilinear_m(page & SLOT_MASK, level, at, s, t);
    let true_point_m = camera_relative_m(pages.planet, view, s, t, true_m);
    let up = up_at(pages.planet, view, s, t);
    let above_m = (point_m[0] - true_point_m[0]) * up[0]
        + (point_m[1] - true_point_m[1]) * up[1]
        + (point_m[2] - true_point_m[2]) * up[2];
    DrawnError { px: above_m.abs() * view.right[3] / distance_m, level }
}

#[cfg(test)]
mod tests {
    use super::super::light::to_srgb;
    use super::*;

    fn bytes(colour: [f32; 3]) -> [i32; 3] {
        to_srgb(colour).map(|c| (c * 255.0).round() as i32)
    }

    fn apart(a: [f32; 3], b: [f32; 3]) -> i32 {
        let (a, b) = (bytes(a), bytes(b));
        (0..3).map(|k| (a[k] - b[k]).abs()).sum()
    }

    #[test]
    fn pages_that_touch_differ() {
        for level in 0..13 {
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let here = page_colour(level, x, y);
                for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
                    assert!(apart(here, page_colour(level, x + dx, y + dy)) > 20, "{level} {x} {y} {dx} {dy}");
                }
                for other in (0..4).map(|k| page_colour(level + 1, k & 1, k >> 1)) {
                    assert!(apart(here, other) > 100, "{level} {x} {y}");
                }
                assert_eq!(apart(here, page_colour(level, x + 2, y + 4)), 0);
            }
        }
    }

    #[test]
    fn errors_are_blue_below_the_threshold_and_red_above() {
        for k in 0..=200u8 {
            let share = f32::from(k) / 100.0;
            let [red, _, blue] = error_colour(share);
            assert_eq!((red < blue, red > blue), (k < 100, k > 100), "{share}");
        }
        assert_eq!(error_colour(7.0), error_colour(2.0));
        // Light at the threshold, dark at both ends.
        let sum = |share: f32| bytes(error_colour(share)).iter().sum::<i32>();
        assert!(sum(1.0) > 2 * sum(0.0) && sum(1.0) > 2 * sum(2.0));
    }

    #[test]
    fn stripes_and_relief_are_seen() {
        let colour = page_colour(0, 0, 0);
        let row: Vec<bool> = (0..24).map(|x| striped(colour, [x, 5]) != colour).collect();
        assert_eq!(row.iter().filter(|&&dark| dark).count(), 8);
        assert_eq!(striped(colour, [3, 2]), striped(colour, [2, 3]));
        let light = |k: f32| in_relief(colour, [k, k, k], [0.5; 3], 0.5);
        assert_eq!(light(0.5), colour);
        assert!(light(0.4)[2] < colour[2] && light(0.6)[2] > colour[2]);
        assert!(in_relief(colour, [0.0; 3], [0.0; 3], 1.0).iter().all(|c| c.is_finite()));
    }
}
