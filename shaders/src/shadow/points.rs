//! Height and sunlight of points: twin of `wgsl/shadow_points.wgsl`.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::exact::shadow_exact;
use super::pages::PagedRelief;
use super::sun::sun_local;
use crate::pages::Pages;

/// The sun over points: `struct PointSun` of `wgsl/shadow_points.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PointSun {
    /// Unit vector to the sun: ECEF on a globe, (east, north, up) on a plane; fourth: radius of
    /// its disk in radians, 0 for a hard edge.
    pub sun: [f32; 4],
    /// Level of the surface the points lie on and of the relief that shades them.
    pub level: u32,
    /// Zero.
    pub padding: [u32; 3],
}

/// A point and its answer: `struct SunlitPoint` of `wgsl/shadow_points.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct SunlitPoint {
    /// Fixed point.
    pub s: u32,
    /// Fixed point.
    pub t: u32,
    /// The answer: height of the surface, metres.
    pub height_m: f32,
    /// The answer: visible part of the sun's disk, 0 to 1.
    pub visible: f32,
}

/// Answers points from pages. Pages that were lacked are asked for; with them answers may differ.
pub fn shadow_points(pages: &Pages<'_>, sun: &PointSun, points: &mut [SunlitPoint]) {
    let PointSun { sun: [x, y, z, disk_rad], level, .. } = *sun;
    points.par_iter_mut().for_each(|point| {
        let at @ [s, t] = [point.s, point.t];
        let towards = if pages.planet.plane != 0 { [x, y, z] } else { sun_local([x, y, z], 1 << 31, s, t) };
        let mut relief = PagedRelief::new(*pages);
        point.height_m = pages.height_m(level, s, t);
        point.visible = shadow_exact(pages.planet, &mut relief, at, point.height_m, level, towards, disk_rad).visible;
    });
}
