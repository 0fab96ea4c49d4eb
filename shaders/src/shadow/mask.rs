//! The sunlight of the nodes of a window: twin of `wgsl/shadow_mask.wgsl`.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::exact::{Relief, Sunlight, shadow_exact};
use super::pages::PagedRelief;
use super::square::square_shift;
use super::sun::{refracted, sun_local};
use crate::pages::Pages;
use crate::planet::Planet;

/// A window of nodes and its sun: `struct ShadowWindow` of `wgsl/shadow_mask.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ShadowWindow {
    /// Unit vector to the sun: ECEF on a globe, (east, north, up) on a plane; fourth: radius of
    /// its disk in radians, 0 for a hard edge.
    pub sun: [f32; 4],
    /// Node column of the first node, at `level`; a globe's columns wrap.
    pub x: u32,
    /// Node row of the first node, at `level`.
    pub y: u32,
    /// Columns of nodes.
    pub columns: u32,
    /// Rows of nodes.
    pub rows: u32,
    /// Level of the nodes and of the relief that shades them.
    pub level: u32,
    /// Density of the air at the ground, 1 on Earth at sea level; 0 refracts nothing.
    pub air: f32,
    /// Zero.
    pub padding: [u32; 2],
}

/// What a window's rays fetched, in all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WindowCounts {
    /// Rays cast.
    pub rays: u64,
    /// Heights of nodes.
    pub heights: u64,
    /// Pairs of extremes.
    pub extremes: u64,
    /// Squares entered.
    pub steps: u64,
}

impl WindowCounts {
    /// With one more ray.
    #[must_use]
    pub fn with(self, light: &Sunlight) -> Self {
        let counts = light.counts;
        Self {
            rays: self.rays + 1,
            heights: self.heights + u64::from(counts.heights),
            extremes: self.extremes + u64::from(counts.extremes),
            steps: self.steps + u64::from(counts.steps),
        }
    }

    /// The sums of both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            heights: self.heights + other.heights,
            extremes: self.extremes + other.extremes,
            steps: self.steps + other.steps,
        }
    }
}

/// Direction to the sun (east, north, up) at a point, lifted by the air.
#[must_use]
pub fn sun_of_window(planet: &Planet, window: &ShadowWindow, s: u32, t: u32) -> [f32; 3] {
    let [x, y, z, _] = window.sun;
    let local = if planet.plane != 0 { [x, y, z] } else { sun_local([x, y, z], 1 << 31, s, t) };
    if window.air == 0.0 { local } else { refracted(local, window.air) }
}

/// Visible part of the sun at every node of a window, 0 to 255, south row first. Each thread makes
/// its own `relief`; `height_m` is the height at (S, T) of the window's level.
pub fn shadow_mask_of<R: Relief>(
    planet: &Planet,
    window: &ShadowWindow,
    relief: impl Fn() -> R + Sync,
    height_m: impl Fn(u32, u32) -> f32 + Sync,
) -> (Vec<u8>, WindowCounts) {
    let shift = square_shift(planet, window.level);
    let mut mask = vec![0; window.columns as usize * window.rows as usize];
    let counts = mask
        .par_chunks_mut((window.columns as usize).max(1))
        .enumerate()
        .map(|(row, out)| {
            let mut relief = relief();
            let mut counts = WindowCounts::default();
            let t = (window.y + row as u32) << shift;
            for (column, out) in (0..).zip(out.iter_mut()) {
                let s = window.x.wrapping_add(column) << shift;
                let sun = sun_of_window(planet, window, s, t);
                let light = shadow_exact(planet, &mut relief, [s, t], height_m(s, t), window.level, sun, window.sun[3]);
                *out = (light.visible * 255.0 + 0.5) as u8;
                counts = counts.with(&light);
            }
            counts
        })
        .reduce(WindowCounts::default, WindowCounts::plus);
    (mask, counts)
}

/// [`shadow_mask_of`] over pages. Pages that a ray lacked are asked for; with them the mask may
/// differ.
#[must_use]
pub fn shadow_mask(pages: &Pages<'_>, window: &ShadowWindow) -> (Vec<u8>, WindowCounts) {
    shadow_mask_of(pages.planet, window, || PagedRelief::new(*pages), |s, t| pages.height_m(window.level, s, t))
}
