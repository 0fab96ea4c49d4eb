//! Twin of `wgsl/frame_draw.wgsl` and of the rasteriser behind it: corners snapped to 256ths of a
//! pixel, the top-left rule, samples at pixel centres, depth near / w, the nearest wins.

use rayon::prelude::*;

use super::clip::{Vertex, clip};
use crate::leb::{Corner, ReliefTriangle};
use crate::planet::{Planet, View};
use crate::position::camera_relative_m;

/// 256ths of a pixel.
const SUBPIXELS: f32 = 256.0;
/// Coordinates stay within this many pixels of the middle of the picture.
const GUARD_PX: f32 = 16384.0;
/// Rows of pixels drawn by one task.
const BAND_ROWS: usize = 16;

/// What each pixel shows: rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Places {
    /// Pixels.
    pub width: u32,
    /// S, T, level plus 128 in bits 0 to 7 and edge distance in 32nds of a pixel in bits 8 to 15.
    pub places: Vec<[u32; 3]>,
    /// Distance of the near plane over that along the axis of sight; 0 in the sky.
    pub depths: Vec<f32>,
}

/// A triangle on the screen.
struct Drawn {
    /// 256ths of a pixel, from the picture's upper left corner.
    corners: [[i64; 2]; 3],
    inverse_w: [f32; 3],
    /// What each corner holds of the whole triangle's corners.
    weights: [[f32; 3]; 3],
    /// Which triangle it is a part of.
    source: u32,
}

/// Draws relief triangles.
#[must_use]
pub fn draw(planet: &Planet, view: &View, triangles: &[ReliefTriangle]) -> Places {
    let (width, height) = (view.width as usize, view.height as usize);
    let drawn: Vec<Drawn> =
        triangles.par_iter().enumerate().flat_map_iter(|(k, t)| project(planet, view, k as u32, t)).collect();
    let mut bands: Vec<Vec<u32>> = vec![Vec::new(); height.div_ceil(BAND_ROWS)];
    for (k, triangle) in drawn.iter().enumerate() {
        let rows = triangle.corners.map(|c| c[1]);
        let band = |row: i64| (row >> 8).clamp(0, height as i64 - 1) as usize / BAND_ROWS;
        let (low, high) = (rows[0].min(rows[1]).min(rows[2]), rows[0].max(rows[1]).max(rows[2]));
        if high >= 0 && low < (height as i64) << 8 {
            bands[band(low)..=band(high)].iter_mut().for_each(|list| list.push(k as u32));
        }
    }
    let mut places = vec![[0; 3]; width * height];
    let mut depths = vec![0.0; width * height];
    let rows = BAND_ROWS * width;
    places.par_chunks_mut(rows).zip(depths.par_chunks_mut(rows)).zip(&bands).enumerate().for_each(
        |(band, ((places, depths), list))| {
            let mut target = Band { view, first_row: band * BAND_ROWS, width, places, depths };
            for &k in list {
                let triangle = &drawn[k as usize];
                target.fill(planet, triangle, &triangles[triangle.source as usize]);
            }
        },
    );
    Places { width: view.width, places, depths }
}

/// Corners in clip space: x, y, w.
fn clip_space(planet: &Planet, view: &View, corner: &Corner) -> [f32; 3] {
    let p = camera_relative_m(planet, view, corner.s, corner.t, corner.height_m);
    let dot = |v: [f32; 4]| v[0] * p[0] + v[1] * p[1] + v[2] * p[2];
    [dot(view.right) / view.tan_x, dot(view.up) / view.tan_y, dot(view.forward)]
}

fn project(planet: &Planet, view: &View, source: u32, triangle: &ReliefTriangle) -> Vec<Drawn> {
    let mut corners = [Vertex { clip: [0.0; 3], weights: [0.0; 3] }; 3];
    for (k, (vertex, corner)) in corners.iter_mut().zip(triangle).enumerate() {
        vertex.clip = clip_space(planet, view, corner);
        vertex.weights[k] = 1.0;
    }
    let (width, height) = (view.width as f32, view.height as f32);
    let guard = 2.0 * GUARD_PX / width.max(height);
    let polygon = clip(corners, view.forward[3], guard);
    let snapped: Vec<([i64; 2], f32)> = polygon
        .iter()
        .map(|v| {
            let inverse = 1.0 / v.clip[2];
            let x = (v.clip[0] * inverse + 1.0) * 0.5 * width;
            let y = (1.0 - v.clip[1] * inverse) * 0.5 * height;
            ([(x * SUBPIXELS).round() as i64, (y * SUBPIXELS).round() as i64], inverse)
        })
        .collect();
    (2..polygon.len())
        .filter_map(|k| {
            let fan = [0, k - 1, k];
            let corners = fan.map(|k| snapped[k].0);
            let outside = |axis: usize, limit: i64| {
                corners.iter().all(|c| c[axis] < 0) || corners.iter().all(|c| c[axis] > limit << 8)
            };
            if area(corners) == 0 || outside(0, i64::from(view.width)) || outside(1, i64::from(view.height)) {
                return None;
            }
            Some(Drawn {
                corners,
                inverse_w: fan.map(|k| snapped[k].1),
                weights: fan.map(|k| polygon[k].weights),
                source,
            })
        })
        .collect()
}

/// Twice the signed area, positive when the corners run clockwise on a screen whose rows go down.
fn area([a, b, c]: [[i64; 2]; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Rows of the picture.
struct Band<'a> {
    view: &'a View,
    first_row: usize,
    width: usize,
    places: &'a mut [[u32; 3]],
    depths: &'a mut [f32],
}

impl Band<'_> {
    fn fill(&mut self, planet: &Planet, triangle: &Drawn, source: &ReliefTriangle) {
        let mut order = [0, 1, 2];
        if area(triangle.corners) < 0 {
            order = [0, 2, 1];
        }
        let corners = order.map(|k| triangle.corners[k]);
        let whole = area(corners);
        let rows = self.places.len() / self.width;
        let reach = |axis: usize, first: i64, count: usize| {
            let values = corners.map(|c| c[axis]);
            let (low, high) = (values.into_iter().min().unwrap_or(0), values.into_iter().max().unwrap_or(0));
            // Pixels whose centres lie between.
            let start = ((low + 127) >> 8).clamp(first, first + count as i64);
            let end = (((high - 128) >> 8) + 1).clamp(first, first + count as i64);
            start..end.max(start)
        };
        let (columns, lines) = (reach(0, 0, self.width), reach(1, self.first_row as i64, rows));
        let edges = [0, 1, 2].map(|k| Edge::new(corners[(k + 1) % 3], corners[(k + 2) % 3]));
        let inverse_area = 1.0 / whole as f32;
        let inverse_w = order.map(|k| triangle.inverse_w[k]);
        let weights = order.map(|k| triangle.weights[k]);
        let slopes = self.slopes(&edges, inverse_area, weights);
        for row in lines {
            let mut inside = edges.map(|edge| edge.at(columns.start, row));
            for column in columns.clone() {
                if inside.iter().zip(&edges).all(|(&value, edge)| value + edge.bias >= 0) {
                    let linear = inside.map(|value| value as f32 * inverse_area);
                    let over_w = linear[0] * inverse_w[0] + linear[1] * inverse_w[1] + linear[2] * inverse_w[2];
                    let depth = self.view.forward[3] * over_w;
                    let at = (row as usize - self.first_row) * self.width + column as usize;
                    if depth > self.depths[at] {
                        self.depths[at] = depth;
                        self.places[at] = place(planet, source, linear, inverse_w, over_w, weights, slopes);
                    }
                }
                for (value, edge) in inside.iter_mut().zip(&edges) {
                    *value += edge.step[0];
                }
            }
        }
    }

    /// Length of the gradient of each corner's weight, a pixel.
    fn slopes(&self, edges: &[Edge; 3], inverse_area: f32, weights: [[f32; 3]; 3]) -> [f32; 3] {
        std::array::from_fn(|corner| {
            let along = |axis: usize| {
                (0..3).map(|k| edges[k].step[axis] as f32 * inverse_area * weights[k][corner]).sum::<f32>()
            };
            along(0).hypot(along(1)).max(1e-12)
        })
    }
}

/// One side as a function that is positive inside.
#[derive(Clone, Copy)]
struct Edge {
    from: [i64; 2],
    way: [i64; 2],
    /// What a pixel to the right and one down add.
    step: [i64; 2],
    /// 0 where the side belongs to the triangle, -1 where it does not.
    bias: i64,
}

impl Edge {
    fn new(from: [i64; 2], to: [i64; 2]) -> Self {
        let way = [to[0] - from[0], to[1] - from[1]];
        let top_left = way[1] < 0 || way[1] == 0 && way[0] > 0;
        Self { from, way, step: [-way[1] << 8, way[0] << 8], bias: if top_left { 0 } else { -1 } }
    }

    fn at(&self, column: i64, row: i64) -> i64 {
        let [x, y] = [(column << 8) + 128 - self.from[0], (row << 8) + 128 - self.from[1]];
        self.way[0] * y - self.way[1] * x
    }
}

/// The fragment stage.
fn place(
    planet: &Planet,
    source: &ReliefTriangle,
    linear: [f32; 3],
    inverse_w: [f32; 3],
    over_w: f32,
    weights: [[f32; 3]; 3],
    slopes: [f32; 3],
) -> [u32; 3] {
    let sum = |shares: [f32; 3], corner: usize| {
        shares[0] * weights[0][corner] + shares[1] * weights[1][corner] + shares[2] * weights[2][corner]
    };
    let shares = [0, 1, 2].map(|k| linear[k] * inverse_w[k] / over_w);
    let base = source[0];
    let offset = |from: u32, to: fn(&Corner) -> u32| {
        let away = |k: usize| to(&source[k]).wrapping_sub(from) as i32 as f32;
        sum(shares, 1) * away(1) + sum(shares, 2) * away(2)
    };
    let s = shifted(base.s, offset(base.s, |c| c.s), planet.plane == 0);
    let t = shifted(base.t, offset(base.t, |c| c.t), false);
    let level = source.iter().map(|c| c.level).min().unwrap_or(0);
    let edge = [0, 1, 2].map(|corner| sum(linear, corner) / slopes[corner]);
    let edge = (edge[0].min(edge[1]).min(edge[2]) * 32.0).clamp(0.0, 255.0);
    [s, t, (level + 128) as u32 | (edge as u32) << 8]
}

/// A fixed-point coordinate some units on: a longitude wraps, others stay between the map's edges.
fn shifted(base: u32, units: f32, wraps: bool) -> u32 {
    let away = units.abs().round_ties_even() as u32;
    match (wraps, units < 0.0) {
        (true, false) => base.wrapping_add(away),
        (true, true) => base.wrapping_sub(away),
        (false, false) => base.saturating_add(away).min(1 << 31),
        (false, true) => base - away.min(base),
    }
}

#[cfg(test)]
mod tests;
