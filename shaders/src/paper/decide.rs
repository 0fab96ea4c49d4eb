//! Whether a patch is split: Algorithm 3 of paper 000.

use super::extent::square_interval_m;
use super::patch::{Patch, level};
use crate::angle::{sin_cos, sin_cos_lat};
use crate::leb::Params;
use crate::leb::active::along_axes;
use crate::pages::{NONE, Pages, SLOT_MASK, USABLE};
use crate::planet::{Planet, View};
use crate::position::camera_relative_m;

/// How far the relief over a patch may lie from the plane of its corners, metres along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prism {
    /// d+, outwards.
    pub above_m: f32,
    /// d-, inwards.
    pub below_m: f32,
}

/// True when a patch is to be split: its prism may show, and the page its parts need is there,
/// which is asked for. A function of the patch's place and size alone.
#[must_use]
pub fn splits(pages: &Pages<'_>, view: &View, params: &Params, patch: &Patch) -> bool {
    let level = level(pages.planet, patch);
    if level < 0 {
        return false;
    }
    let level = level as u32;
    if level > pages.planet.root_level {
        return shows(pages, view, params, patch, crown_m(pages, params, patch));
    }
    let [_, [s, t], _] = patch.midpoints();
    let at = pages.place(level, s, t);
    let page = pages.find(level, at.x, at.y);
    let usable = page != NONE && page & USABLE != 0;
    let deviation_m = if usable {
        pages.deviation_m(page & SLOT_MASK, at.column, at.row)
    } else {
        // S_0 and the patch lie in the same interval.
        let [low, high] = square_interval_m(pages, patch);
        high - low
    };
    let shows = shows(pages, view, params, patch, deviation_m);
    if usable || shows {
        pages.ask(level, at.x, at.y);
    }
    usable && shows
}

/// Deviation of a node above the coarsest stored level, from the root's pages; the planet's range
/// where they say nothing.
fn crown_m(pages: &Pages<'_>, params: &Params, patch: &Patch) -> f32 {
    let [_, [s, t], _] = patch.midpoints();
    let root = pages.planet.root_level;
    let at = pages.place(root, s, t);
    let page = pages.find(root, at.x, at.y);
    if page == NONE {
        return params.range_m;
    }
    let deviation_m = pages.deviation_m(page & SLOT_MASK, at.column, at.row);
    if deviation_m > 0.0 { deviation_m.min(params.range_m) } else { params.range_m }
}

/// True when the prism over a patch is seen larger than n_px pixels.
fn shows(pages: &Pages<'_>, view: &View, params: &Params, patch: &Patch, deviation_m: f32) -> bool {
    let planet = pages.planet;
    let places = patch.corners();
    let corners = places.map(|[s, t]| camera_relative_m(planet, view, s, t, corner_height_m(pages, s, t)));
    let prism = Prism { above_m: deviation_m + bulge_m(planet, corners[1], corners[2]), below_m: deviation_m };
    if prism.above_m <= 0.0 {
        return false;
    }
    let [_, [s, t], _] = patch.midpoints();
    let middle = camera_relative_m(planet, view, s, t, corner_height_m(pages, s, t));
    let (mut radius2, distance2) = (0.0f32, dot(middle, middle));
    for corner in corners {
        let d = sub(corner, middle);
        radius2 = radius2.max(dot(d, d));
    }
    if distance2 < 4.0 * radius2 && shows_near(view, params, prism, distance2.sqrt() - radius2.sqrt()) {
        return true;
    }
    let mut shows = false;
    for k in 0..3 {
        let up = normal_at(planet, view, places[k]);
        shows = shows || shows_at(view, params, prism, corners[k], up);
    }
    shows
}

/// Height of S_0 at a corner of a patch, metres, from the page of the coarsest level that has this
/// node, or from a coarser one. The same for all patches and fillers that meet there.
#[must_use]
pub fn corner_height_m(pages: &Pages<'_>, s: u32, t: u32) -> f32 {
    pages.height_m(corner_level(pages.planet, s, t), s, t)
}

/// The coarsest level that has the node (S, T) of level 0.
#[must_use]
pub fn corner_level(planet: &Planet, s: u32, t: u32) -> u32 {
    ((s | t).trailing_zeros().min(31) - (31 - planet.m)).min(planet.root_level)
}

/// How far the body bulges over the flat triangle with this longest side: the sagitta of its
/// circle, metres; 0 on a plane.
fn bulge_m(planet: &Planet, a: [f32; 3], b: [f32; 3]) -> f32 {
    if planet.plane != 0 {
        return 0.0;
    }
    let least = (planet.a_m * (planet.a_m / planet.b_m)).min(planet.b_m * (planet.b_m / planet.a_m));
    let radius = (least + planet.min_m).max(0.01 * least);
    let chord = sub(b, a);
    dot(chord, chord) / (8.0 * radius)
}

/// Unit normal of the body at (S, T) in the camera's frame.
fn normal_at(planet: &Planet, view: &View, [s, t]: [u32; 2]) -> [f32; 3] {
    if planet.plane != 0 {
        return [0.0, 0.0, 1.0];
    }
    let [sin_lon, cos_lon] = sin_cos(s.wrapping_sub(view.camera_s));
    let [sin_lat, cos_lat] = sin_cos_lat(t);
    [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat]
}

/// Algorithm 3 at one corner: whether the prism's edge there projects to more than the threshold.
///
/// In normalised device coordinates the difference of p + d+ n and p - d- n is
/// (d+ + d-) (n_x z - n_z x) / (z+ z- tan) in x, likewise in y: no two close numbers are subtracted.
fn shows_at(view: &View, params: &Params, prism: Prism, corner: [f32; 3], up: [f32; 3]) -> bool {
    let [x, y, z] = along_axes(view, corner);
    let [nx, ny, nz] = along_axes(view, up);
    let distance = dot(corner, corner).sqrt();
    let (z_above, z_below) = (z + prism.above_m * nz, z - prism.below_m * nz);
    // Further off the axis than anything in view, or behind the camera: as at the view's corner.
    if z_above.min(z_below) < 0.5 * params.cos_corner * distance {
        let reach = distance - prism.above_m.max(prism.below_m);
        return shows_near(view, params, prism, reach);
    }
    let scale = (prism.above_m + prism.below_m) / (z_above * z_below);
    let (rx, ry) = (scale * (nx * z - nz * x) / view.tan_x, scale * (ny * z - nz * y) / view.tan_y);
    rx * rx + ry * ry > threshold2(view)
}

/// The same in whatever direction the prism and its edge lie, at least `distance_m` away.
fn shows_near(view: &View, params: &Params, prism: Prism, distance_m: f32) -> bool {
    let cos = params.cos_corner;
    let r = (prism.above_m + prism.below_m) / (cos * cos * view.tan_x.min(view.tan_y));
    distance_m <= 0.0 || r * r > threshold2(view) * (distance_m * distance_m)
}

/// (n_px max(2/w, 2/h))^2.
fn threshold2(view: &View) -> f32 {
    let n = view.up[3] * (2.0 / view.width as f32).max(2.0 / view.height as f32);
    n * n
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
