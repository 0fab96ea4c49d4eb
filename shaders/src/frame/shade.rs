//! Drawn places shaded to colours. Twin of `wgsl/lib/shade_pixels.wgsl`.

use rayon::prelude::*;

use super::Places;
use super::ground::{Ground, detail, finest_level, ground_between, metres_per_unit};
use super::light::{detail_colour, exaggeration, ground_light, mix, normalize, sky_colour, smoothstep, tint, to_srgb};
use super::overlay::{drawn_error, error_colour, in_relief, page_colour, striped};
use super::sea::sea_level_m;
use super::style::{Overlay, Shadow, Shore, Style};
use crate::pages::{NONE, Pages, key};
use crate::planet::View;
use crate::shadow::pages::PagedRelief;
use crate::shadow::paper::{PaperMap, Reading};
use crate::shadow::shadow_exact;
use crate::shadow::sun::{refracted, sun_local};

/// Shaded pixels, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shaded {
    /// Bytes from the lowest: red, green, blue (sRGB), visible part of the sun's disk.
    pub colours: Vec<u32>,
    /// Metres from the camera; 0 in the sky.
    pub distances_m: Vec<f32>,
    /// East and north of the ground's unit normal, 16 bits each, -1 to 1; 0 in the sky.
    pub normals: Vec<u32>,
}

/// What shading reads besides the pages.
#[derive(Clone, Copy, Debug)]
pub struct Maps<'a> {
    /// Sea levels, metres: the grid of [`super::sea`].
    pub sea_m: &'a [f32],
    /// Where shadows are the paper's.
    pub paper: Option<&'a PaperMap>,
}

/// What the rays of a frame fetched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fetches {
    /// Rays cast: one a pixel of ground.
    pub rays: u64,
    /// Heights of nodes.
    pub heights: u64,
    /// Pairs of extremes.
    pub extremes: u64,
    /// Squares entered.
    pub steps: u64,
}

impl Fetches {
    fn and(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            heights: self.heights + other.heights,
            extremes: self.extremes + other.extremes,
            steps: self.steps + other.steps,
        }
    }
}

/// Shades what was drawn. The grid of [`super::sea`] and the paper's map are read where the style
/// says so.
#[must_use]
pub fn shade(pages: &Pages<'_>, view: &View, style: &Style, maps: Maps<'_>, places: &Places) -> (Shaded, Fetches) {
    let (width, count) = (view.width as usize, places.depths.len());
    let mut shaded = Shaded { colours: vec![0; count], distances_m: vec![0.0; count], normals: vec![0; count] };
    let Shaded { colours, distances_m, normals } = &mut shaded;
    let rows = colours
        .par_chunks_mut(width)
        .zip(distances_m.par_chunks_mut(width))
        .zip(normals.par_chunks_mut(width))
        .enumerate();
    let fetches = rows.map(|(row, ((colours, distances_m), normals))| {
        let mut canvas = Canvas { pages, view, style, maps, places, fetches: Fetches::default() };
        for column in 0..width {
            (colours[column], distances_m[column], normals[column]) = canvas.pixel([column as u32, row as u32]);
        }
        canvas.fetches
    });
    let fetches = fetches.reduce(Fetches::default, Fetches::and);
    (shaded, fetches)
}

/// What a pixel of ground shows.
struct Spot {
    /// Column and row.
    pixel: [u32; 2],
    s: u32,
    t: u32,
    /// The third word of [`Places::places`].
    marks: u32,
    /// From the camera, in its frame.
    point_m: [f32; 3],
    distance_m: f32,
}

struct Canvas<'a> {
    pages: &'a Pages<'a>,
    view: &'a View,
    style: &'a Style,
    maps: Maps<'a>,
    places: &'a Places,
    fetches: Fetches,
}

impl Canvas<'_> {
    /// `shade_pixels`.
    fn pixel(&mut self, pixel: [u32; 2]) -> (u32, f32, u32) {
        let view = self.view;
        let [x, y, stretch] = self.sight(pixel);
        let along: [f32; 3] = std::array::from_fn(|k| view.forward[k] + view.right[k] * x + view.up[k] * y);
        let (depth, place) = self.drawn(pixel);
        if depth == 0.0 {
            let ray = along.map(|c| c / stretch);
            return (pack_unorm(to_srgb(sky_colour(self.pages.planet, view, self.style, ray)), 0.0), 0.0, 0);
        }
        let axial_m = view.forward[3] / depth;
        let [s, t, marks] = place;
        let point_m = along.map(|c| c * axial_m);
        self.shade_ground(&Spot { pixel, s, t, marks, point_m, distance_m: axial_m * stretch })
    }

    fn drawn(&self, [column, row]: [u32; 2]) -> (f32, [u32; 3]) {
        let at = (row * self.view.width + column) as usize;
        (self.places.depths[at], self.places.places[at])
    }

    /// A pixel's line of sight: right and up where it is 1 along the axis, and its length there.
    fn sight(&self, [column, row]: [u32; 2]) -> [f32; 3] {
        let view = self.view;
        let x = ((column as f32 + 0.5) * 2.0 / view.width as f32 - 1.0) * view.tan_x;
        let y = (1.0 - (row as f32 + 0.5) * 2.0 / view.height as f32) * view.tan_y;
        [x, y, (1.0 + x * x + y * y).sqrt()]
    }

    /// The page that a pixel's height is from; none in the sky and beyond the picture.
    fn page_at(&self, pixel: [u32; 2]) -> u32 {
        if pixel[0] >= self.view.width || pixel[1] >= self.view.height {
            return NONE;
        }
        let (depth, [s, t, _]) = self.drawn(pixel);
        if depth == 0.0 {
            return NONE;
        }
        let wanted = detail(self.pages.planet, self.view, self.view.forward[3] / depth * self.sight(pixel)[2]) as u32;
        let level = finest_level(self.pages, wanted, s, t);
        let at = self.pages.place(level, s, t);
        key(level, at.x, at.y)
    }

    /// The pages' colours, their borders two pixels wide.
    fn over_pages(&self, spot: &Spot, wanted: u32, level: u32) -> [f32; 3] {
        let at = self.pages.place(level, spot.s, spot.t);
        let mut colour = page_colour(level, at.x, at.y);
        let [column, row] = spot.pixel;
        if level > wanted {
            colour = striped(colour, spot.pixel);
        }
        let here = key(level, at.x, at.y);
        let beside =
            [[column + 1, row], [column.wrapping_sub(1), row], [column, row + 1], [column, row.wrapping_sub(1)]];
        let differs = |page: u32| page != here && page != NONE;
        if beside.into_iter().any(|pixel| differs(self.page_at(pixel))) {
            colour = colour.map(|c| c * 0.1);
        }
        colour
    }

    fn over_error(&self, spot: &Spot) -> [f32; 3] {
        let error = drawn_error(self.pages, self.view, [spot.s, spot.t], spot.point_m, spot.distance_m);
        let colour = error_colour(error.px / self.view.up[3]);
        if error.level > 0 { striped(colour, spot.pixel) } else { colour }
    }

    /// What the overlay makes of the ground's colour; `wanted` and `level` are of the page that was
    /// wanted and of that which its height is from.
    fn over(
        &self,
        spot: &Spot,
        colour: [f32; 3],
        [wanted, level]: [u32; 2],
        light: [f32; 3],
        sun: [f32; 3],
    ) -> [f32; 3] {
        let style = self.style;
        if style.overlay == Overlay::Pages as u32 {
            let level_light = ground_light(style, [0.0, 0.0], sun, 1.0);
            return in_relief(self.over_pages(spot, wanted, level), light, level_light, 0.9);
        }
        if style.overlay == Overlay::Error as u32 {
            let level_light = ground_light(style, [0.0, 0.0], sun, 1.0);
            return in_relief(self.over_error(spot), light, level_light, 0.5);
        }
        let mut marked = colour;
        if style.overlay == Overlay::Detail as u32 {
            marked = mix(colour, detail_colour((spot.marks & 255) as i32 - 128), 0.45);
        }
        let edge = ((spot.marks >> 8) & 255) as f32 / 32.0;
        mix([0.01, 0.012, 0.02], marked, 0.25 + 0.75 * smoothstep(0.2, 0.8, edge))
    }

    fn shade_ground(&mut self, spot: &Spot) -> (u32, f32, u32) {
        let (pages, view, style) = (self.pages, self.view, self.style);
        let Spot { s, t, distance_m, .. } = *spot;
        let level = detail(pages.planet, view, distance_m);
        let here = ground_between(pages, level, s, t, metres_per_unit(pages.planet, t));
        let sun = self.sun_at(s, t);
        let visible = self.sunlight(&here, s, t, sun);
        let exaggeration = exaggeration(style, distance_m / view.right[3]);
        let steep = [here.east * exaggeration, here.north * exaggeration];
        let sea_m = if style.sea == Shore::Grid as u32 { sea_level_m(self.maps.sea_m, s, t) } else { 0.0 };
        let light = ground_light(style, steep, sun, visible);
        let tint = tint(style, here.height_m - sea_m);
        let mut colour = std::array::from_fn(|k| tint[k] * light[k]);
        if style.overlay != Overlay::None as u32 {
            colour = self.over(spot, colour, [level as u32, here.level], light, sun);
        }
        let normal = normalize([-here.east, -here.north, 1.0]);
        (pack_unorm(to_srgb(colour), visible), distance_m, pack_snorm([normal[0], normal[1]]))
    }

    fn sunlight(&mut self, here: &Ground, s: u32, t: u32, sun: [f32; 3]) -> f32 {
        if self.style.shadow == Shadow::None as u32 {
            return 1.0;
        }
        let light = match self.maps.paper {
            Some(map) if self.style.shadow == Shadow::Paper as u32 => {
                let unit = 1.0 / (1u64 << (31 - map.m)) as f32;
                let at = [s as f32 * unit + 0.5, t as f32 * unit + 0.5];
                let height_m = map.paper_bilinear_m(here.level, at[0], at[1]);
                map.paper_shadow(at, height_m, here.level, sun, Reading::Meant)
            }
            _ => {
                let mut relief = PagedRelief::new(*self.pages);
                let disk_rad = self.view.sun[3];
                shadow_exact(self.pages.planet, &mut relief, [s, t], here.level_m, here.level, sun, disk_rad)
            }
        };
        self.fetches = self.fetches.and(Fetches {
            rays: 1,
            heights: light.counts.heights.into(),
            extremes: light.counts.extremes.into(),
            steps: light.counts.steps.into(),
        });
        light.visible
    }

    fn sun_at(&self, s: u32, t: u32) -> [f32; 3] {
        let [x, y, z, _] = self.view.sun;
        let sun = match self.pages.planet.plane {
            0 => sun_local([x, y, z], self.view.camera_s, s, t),
            _ => [x, y, z],
        };
        if self.style.air > 0.0 { refracted(sun, self.style.air) } else { sun }
    }
}

/// `pack4x8unorm`.
fn pack_unorm(rgb: [f32; 3], alpha: f32) -> u32 {
    let byte = |c: f32| (0.5 + 255.0 * c.clamp(0.0, 1.0)) as u32;
    byte(rgb[0]) | byte(rgb[1]) << 8 | byte(rgb[2]) << 16 | byte(alpha) << 24
}

/// `pack2x16snorm`.
fn pack_snorm(v: [f32; 2]) -> u32 {
    let [x, y] = v.map(|c| (0.5 + 32767.0 * c.clamp(-1.0, 1.0)).floor() as i32 as u32 & 0xffff);
    x | y << 16
}
