//! Level of detail, height and slope of the ground at a pixel. Twin of
//! `wgsl/lib/shade_ground.wgsl`.
//!
//! Slopes are central differences of S_q over one node to each side, blended between the two
//! levels that are next to the pixel's width (paper 002, step 7; paper 001, Algo 1 with the
//! width across the line of sight).

use crate::angle::{UNIT_RAD, sin_cos_lat};
use crate::pages::{NONE, Pages, SLOT_MASK, TilePlace};
use crate::planet::{Planet, View};

const POLE: u32 = 1 << 31;

/// Height and slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Metres.
    pub height_m: f32,
    /// Rise eastwards, metres a metre.
    pub east: f32,
    /// Rise northwards, metres a metre.
    pub north: f32,
    /// The finest level it is made from.
    pub level: u32,
    /// Height of that level's surface, metres.
    pub level_m: f32,
}

/// Metres of one unit of S and of T at latitude T.
#[must_use]
pub fn metres_per_unit(planet: &Planet, t: u32) -> [f32; 2] {
    if planet.plane != 0 {
        return [planet.unit_x_m, planet.unit_y_m];
    }
    let [sin, cos] = sin_cos_lat(t);
    let w2 = 1.0 - planet.e2 * sin * sin;
    let n = planet.a_m / w2.sqrt();
    [n * cos.max(1e-7) * UNIT_RAD, n * (1.0 - planet.e2) / w2 * UNIT_RAD]
}

/// The level whose nodes are a pixel apart at a distance, with its fraction.
#[must_use]
pub fn detail(planet: &Planet, view: &View, distance_m: f32) -> f32 {
    let unit_m = if planet.plane != 0 { planet.unit_y_m } else { planet.a_m * UNIT_RAD };
    let spacing_m = unit_m * (1u32 << (31 - planet.m)) as f32;
    let level = (distance_m / (view.right[3] * spacing_m)).max(1.0).log2();
    level.min(planet.root_level as f32)
}

fn height_near_m(pages: &Pages<'_>, level: u32, s: u32, t: u32, home: TilePlace, page: u32) -> f32 {
    let at = pages.place(level, s, t);
    if page != NONE && at.x == home.x && at.y == home.y {
        return pages.bilinear_m(page & SLOT_MASK, level, at, s, t);
    }
    pages.height_m(level, s, t)
}

/// The level of the finest page at `level` or coarser.
pub(super) fn finest_page(pages: &Pages<'_>, level: u32, s: u32, t: u32) -> u32 {
    let here = |k: &u32| {
        let at = pages.place(*k, s, t);
        pages.find(*k, at.x, at.y) != NONE
    };
    (level..pages.planet.root_level).find(here).unwrap_or(pages.planet.root_level)
}

/// The same; the page is asked for, and all above it then count as used.
pub(super) fn finest_level(pages: &Pages<'_>, level: u32, s: u32, t: u32) -> u32 {
    let first = pages.place(level, s, t);
    pages.ask(level, first.x, first.y);
    finest_page(pages, level, s, t)
}

/// Height and slope of S_level.
#[must_use]
pub fn ground(pages: &Pages<'_>, level: u32, s: u32, t: u32, per_unit: [f32; 2]) -> Ground {
    let home = pages.place(level, s, t);
    let page = pages.find(level, home.x, home.y);
    let step_t = 1u32 << (31 - pages.planet.m + level);
    let step_s = (step_t as f32 * (per_unit[1] / per_unit[0])).min(5.368_709e8) as u32;
    let (mut west, mut east) = (s.wrapping_sub(step_s), s.wrapping_add(step_s));
    if pages.planet.plane != 0 {
        west = s - step_s.min(s);
        east = (s + step_s).min(POLE);
    }
    let south = t - step_t.min(t);
    let north = (t + step_t).min(POLE);
    let height = |s, t| height_near_m(pages, level, s, t, home, page);
    let rise_east = height(east, t) - height(west, t);
    let rise_north = height(s, north) - height(s, south);
    let here_m = height(s, t);
    Ground {
        height_m: here_m,
        level,
        level_m: here_m,
        east: rise_east / (east.wrapping_sub(west) as f32 * per_unit[0]),
        north: rise_north / ((north - south) as f32 * per_unit[1]),
    }
}

/// Height and slope between two levels; where the finer one is not at hand, those of the finest
/// that is.
#[must_use]
pub fn ground_between(pages: &Pages<'_>, level: f32, s: u32, t: u32, per_unit: [f32; 2]) -> Ground {
    let wanted = level as u32;
    let share = level - wanted as f32;
    let fine = finest_level(pages, wanted, s, t);
    let a = ground(pages, fine, s, t, per_unit);
    if share == 0.0 || fine > wanted || fine == pages.planet.root_level {
        return a;
    }
    let b = ground(pages, fine + 1, s, t, per_unit);
    Ground {
        height_m: a.height_m + (b.height_m - a.height_m) * share,
        east: a.east + (b.east - a.east) * share,
        north: a.north + (b.north - a.north) * share,
        level: fine,
        level_m: a.level_m,
    }
}
