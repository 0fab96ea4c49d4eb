//! The passes, and what they yield.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::active::judge;
use super::cull::hidden;
use super::params::Params;
use super::region::above_ground;
use super::triangle::{Triangle, start, start_count};
use crate::pages::Pages;
use crate::planet::View;

/// Passes that surely suffice: two bisections each, from the start to a step of one unit.
pub const PASSES: u32 = 30;

/// A corner of a relief triangle: `struct Corner` of `wgsl/lib/leb_corner.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Corner {
    /// Fixed point.
    pub s: u32,
    /// Fixed point.
    pub t: u32,
    /// Height of S_0, metres.
    pub height_m: f32,
    /// Level of detail: the coarsest level that has this node; below 0 inside a level-0 cell.
    pub level: i32,
}

/// Corners counter-clockwise seen from outside, the right-angled one first.
pub type ReliefTriangle = [Corner; 3];

/// What a tessellation did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Passes run.
    pub passes: u32,
    /// Triangles judged.
    pub tested: u32,
    /// Triangles culled.
    pub culled: u32,
    /// True when a list was full and triangles were dropped: the mesh has holes.
    pub overflow: bool,
}

/// What is drawn.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// In an order that depends on planet and view only.
    pub triangles: Vec<ReliefTriangle>,
    /// How they came about.
    pub stats: Stats,
}

/// What became of a triangle.
enum Fate {
    Culled,
    Drawn(Triangle),
    Halved([Triangle; 2]),
}

/// The relief triangles of a view.
#[must_use]
pub fn tessellate(pages: &Pages<'_>, view: &View, params: &Params) -> Mesh {
    let plane = pages.planet.plane != 0;
    let horizon = params.horizon != 0 && above_ground(pages, view);
    let mut list: Vec<Triangle> = (0..start_count(plane)).map(|index| start(plane, index)).collect();
    let mut mesh = Mesh::default();
    while !list.is_empty() && mesh.stats.passes < PASSES {
        let (next, drawn, tested, culled) = list
            .par_chunks(256)
            .map(|chunk| {
                let mut out = (Vec::new(), Vec::new(), 0, 0);
                chunk.iter().for_each(|&triangle| two_steps(pages, view, params, horizon, triangle, &mut out));
                out
            })
            .reduce(
                || (Vec::new(), Vec::new(), 0, 0),
                |mut a, b| {
                    a.0.extend(b.0);
                    a.1.extend(b.1);
                    (a.0, a.1, a.2 + b.2, a.3 + b.3)
                },
            );
        mesh.stats.passes += 1;
        mesh.stats.tested += tested;
        mesh.stats.culled += culled;
        mesh.triangles.extend(drawn);
        mesh.stats.overflow |= next.len() > params.list_capacity as usize;
        list = next;
        list.truncate(params.list_capacity as usize);
    }
    mesh.stats.overflow |= !list.is_empty() || mesh.triangles.len() > params.relief_capacity as usize;
    mesh.triangles.truncate(params.relief_capacity as usize);
    mesh
}

/// One triangle through a pass: at most two bisections.
fn two_steps(
    pages: &Pages<'_>,
    view: &View,
    params: &Params,
    horizon: bool,
    triangle: Triangle,
    out: &mut (Vec<Triangle>, Vec<ReliefTriangle>, u32, u32),
) {
    let mut settle = |triangle: Triangle| {
        out.2 += 1;
        let fate = fate(pages, view, params, horizon, triangle);
        match &fate {
            Fate::Culled => out.3 += 1,
            Fate::Drawn(triangle) => out.1.extend(relief(pages, triangle)),
            Fate::Halved(_) => {}
        }
        fate
    };
    if let Fate::Halved(halves) = settle(triangle) {
        for half in halves {
            if let Fate::Halved(quarters) = settle(half) {
                out.0.extend(quarters);
            }
        }
    }
}

fn fate(pages: &Pages<'_>, view: &View, params: &Params, horizon: bool, triangle: Triangle) -> Fate {
    let node = triangle.node();
    let judgement = judge(pages, view, params, &node, &triangle.parent());
    if hidden(view, params, &node, &judgement.region, horizon) {
        Fate::Culled
    } else if judgement.active && triangle.divisible() {
        Fate::Halved(triangle.halves())
    } else {
        Fate::Drawn(triangle)
    }
}

/// The relief triangle; none where two corners are the same pole: its two other sides are one
/// line in space, along which its neighbours meet.
fn relief(pages: &Pages<'_>, triangle: &Triangle) -> Option<ReliefTriangle> {
    let corners = triangle.corners();
    if pages.planet.plane == 0 {
        for pole in [0, 1 << 31] {
            if corners.iter().filter(|c| c[1] == pole).count() > 1 {
                return None;
            }
        }
    }
    Some(corners.map(|[s, t]| corner(pages, s, t)))
}

fn corner(pages: &Pages<'_>, s: u32, t: u32) -> Corner {
    // A plane's corners and a pole at the seam have no other bound.
    let level = ((s | t).trailing_zeros().min(31)) as i32 - (31 - pages.planet.m as i32);
    let page_level = level.clamp(0, pages.planet.root_level as i32) as u32;
    Corner { s, t, height_m: pages.height_m(page_level, s, t), level }
}
