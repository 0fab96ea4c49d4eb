//! The passes, and what they yield.

use rayon::prelude::*;

use super::decide::{corner_height_m, corner_level, splits};
use super::extent::invisible;
use super::patch::{Patch, start, start_count, start_exponent};
use crate::leb::region::above_ground;
use crate::leb::{Corner, Params, ReliefTriangle};
use crate::pages::Pages;
use crate::planet::{Planet, View};

/// What a tessellation did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Passes run, the start not counted.
    pub passes: u32,
    /// Patches that came about.
    pub tested: u32,
    /// Patches of them that cannot be seen.
    pub culled: u32,
    /// Patches of them that were split.
    pub split: u32,
    /// Relief triangles, without those that have no area because they lie on a pole.
    pub relief: u32,
    /// Vertical triangles between a divided and an undivided side.
    pub fillers: u32,
    /// True when a list was full and something was left out: the mesh has holes.
    pub overflow: bool,
}

/// What is drawn.
#[derive(Clone, Debug, Default)]
pub struct Drawn {
    /// Relief triangles and fillers, in an order that depends on planet, pages and view only.
    pub triangles: Vec<ReliefTriangle>,
    /// How they came about.
    pub stats: Stats,
}

/// Passes that surely suffice.
#[must_use]
pub fn passes(planet: &Planet) -> u32 {
    start_exponent(planet) - (31 - planet.m) + 1
}

/// The relief triangles and fillers of a view.
#[must_use]
pub fn tessellate(pages: &Pages<'_>, view: &View, params: &Params) -> Drawn {
    let horizon = params.horizon != 0 && above_ground(pages, view);
    let pass = Pass { pages, view, params, horizon };
    let mut drawn = Drawn::default();
    let mut list =
        pass.run(&mut drawn, start_count(pages.planet), |index, out| out.keep(&pass, start(pages.planet, index)));
    while !list.is_empty() {
        drawn.stats.passes += 1;
        list = pass.run(&mut drawn, list.len() as u32, |index, out| pass.patch(&list[index as usize], out));
    }
    drawn
}

/// What all patches of a pass share.
struct Pass<'a> {
    pages: &'a Pages<'a>,
    view: &'a View,
    params: &'a Params,
    horizon: bool,
}

/// What some patches of a pass came to.
#[derive(Default)]
struct Out {
    list: Vec<Patch>,
    triangles: Vec<ReliefTriangle>,
    stats: Stats,
}

impl Out {
    /// Keeps a patch for the next pass if it may be seen.
    fn keep(&mut self, pass: &Pass<'_>, patch: Patch) {
        self.stats.tested += 1;
        if invisible(pass.pages, pass.view, pass.params, pass.horizon, &patch) {
            self.stats.culled += 1;
        } else {
            self.list.push(patch);
        }
    }

    /// Draws a triangle, unless it lies on a pole and so has no area.
    fn draw(&mut self, pages: &Pages<'_>, corners: [[u32; 2]; 3]) -> u32 {
        if pages.planet.plane == 0 && on_pole(&corners) {
            return 0;
        }
        self.triangles.push(corners.map(|[s, t]| corner(pages, s, t)));
        1
    }
}

impl Pass<'_> {
    /// Runs a pass of `count` items, adds to what is drawn and returns the next list.
    fn run(&self, drawn: &mut Drawn, count: u32, item: impl Fn(u32, &mut Out) + Sync) -> Vec<Patch> {
        const CHUNK: u32 = 256;
        let parts: Vec<Out> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut out = Out::default();
                (chunk * CHUNK..count.min((chunk + 1) * CHUNK)).for_each(|index| item(index, &mut out));
                out
            })
            .collect();
        let mut list = Vec::new();
        for part in parts {
            list.extend(part.list);
            drawn.triangles.extend(part.triangles);
            let (all, own) = (&mut drawn.stats, part.stats);
            all.tested += own.tested;
            all.culled += own.culled;
            all.split += own.split;
            all.relief += own.relief;
            all.fillers += own.fillers;
        }
        let fits = |len: usize, capacity: u32| len <= capacity as usize;
        drawn.stats.overflow |= !fits(list.len(), self.params.list_capacity);
        drawn.stats.overflow |= !fits(drawn.triangles.len(), self.params.relief_capacity);
        list.truncate(self.params.list_capacity as usize);
        drawn.triangles.truncate(self.params.relief_capacity as usize);
        list
    }

    /// One patch through a pass: a relief triangle, or the parts of its fan and the fillers on sides
    /// beyond which there is no split patch.
    fn patch(&self, patch: &Patch, out: &mut Out) {
        if !splits(self.pages, self.view, self.params, patch) {
            out.stats.relief += out.draw(self.pages, patch.corners());
            return;
        }
        out.stats.split += 1;
        let (corners, midpoints) = (patch.corners(), patch.midpoints());
        let mut hanging = [false; 3];
        for side in 0..3u32 {
            let k = side as usize;
            hanging[k] = patch.hangs(side)
                || !patch.on_edge(self.pages.planet.plane != 0, side)
                    && !splits(self.pages, self.view, self.params, &patch.beyond(side));
            if hanging[k] {
                out.stats.fillers += out.draw(self.pages, [corners[k], corners[(k + 1) % 3], midpoints[k]]);
            }
        }
        for part in patch.parts(hanging) {
            out.keep(self, part);
        }
    }
}

fn on_pole(corners: &[[u32; 2]; 3]) -> bool {
    [0, 1 << 31].into_iter().any(|pole| corners.iter().filter(|c| c[1] == pole).count() > 1)
}

fn corner(pages: &Pages<'_>, s: u32, t: u32) -> Corner {
    let level = corner_level(pages.planet, s, t);
    Corner { s, t, height_m: corner_height_m(pages, s, t), level: level as i32 }
}
