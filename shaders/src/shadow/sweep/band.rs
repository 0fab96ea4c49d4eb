//! A band of strips, from the far end of the map to the near one.

use multiversion::multiversion;

use super::slab::{Piece, Slab, slab};
use super::{Frame, PlaneNodes, SweepCounts};

/// Strips of a band.
pub const BAND: usize = 256;
/// Strips beside a band whose heights are kept: a ray's patches lie up to three strips away.
const PAD: usize = 4;
const STRIDE: usize = BAND + 2 * PAD;
/// Rays in step.
const LANES: usize = 16;
/// A height below all relief, metres.
const DEEP: f32 = -1.0e30;

type Lanes = [f32; LANES];

/// The buffers of a band, reused from one to the next: [`STRIDE`] values a row.
#[derive(Default)]
pub struct Band {
    heights_m: Vec<f32>,
    /// A ray that is at least this high at the row line is lit.
    above_m: Vec<f32>,
    /// A ray that is lower than this at the row line is in shadow.
    below_m: Vec<f32>,
}

/// One row of rays on its way.
struct Rays<'a> {
    band: &'a Band,
    /// Row of the starts.
    along: usize,
    /// Rows of cells.
    rows: usize,
    climb_m: f64,
    near: f32,
    /// The slabs ahead, nearest first, as far as a ray has needed them.
    slabs: &'a [Slab],
    /// First and last place in the near row whose cell is on the map, for each slab.
    inside: &'a [[isize; 2]],
}

impl Band {
    /// Shades the nodes of the strips from `start` on: [`BAND`] bytes a row, 1 lit, 0 in shadow.
    pub fn shade<const COUNT: bool, H: Copy + Into<f32>>(
        &mut self,
        nodes: &PlaneNodes<'_, H>,
        frame: &Frame,
        start: i64,
    ) -> (Vec<u8>, SweepCounts) {
        let rows = frame.cells[0];
        let size = (rows + 1) * STRIDE;
        for buffer in [&mut self.heights_m, &mut self.above_m, &mut self.below_m] {
            buffer.resize(size, 0.0);
        }
        let mut mask = vec![1; (rows + 1) * BAND];
        let mut counts = SweepCounts::default();
        let places: Vec<(i64, f64)> = (0..=rows).map(|along| frame.row(along)).collect();
        let across = frame.cells[1] as i64;
        let mut slabs: Vec<Slab> = Vec::new();
        let mut inside: Vec<[isize; 2]> = Vec::new();
        for along in (0..=rows).rev() {
            // Place k of a row holds the node k - first across.
            let (strip, phase) = places[along];
            let first = PAD as i64 - start + strip;
            self.load(nodes, frame, along, first);
            let on_map = first <= (BAND + PAD) as i64 && first + across >= PAD as i64;
            let far = (along < rows && on_map).then(|| {
                let slip = places[along + 1].0 - strip;
                slab(0.0, phase, slip, frame.shear)
            });
            self.bound(along, far, frame.climb_m as f32);
            self.clip(along, first, phase, across);
            if far.is_none() {
                continue;
            }
            slabs.clear();
            inside.clear();
            for chunk in 0..BAND / LANES {
                let at = PAD + chunk * LANES;
                let out = &mut mask[along * BAND + chunk * LANES..][..LANES];
                loop {
                    let rays = Rays {
                        band: self,
                        along,
                        rows,
                        climb_m: frame.climb_m,
                        near: frame.near,
                        slabs: &slabs,
                        inside: &inside,
                    };
                    let needed = slabs.len() + 8;
                    if let Some(found) = cast::<COUNT>(&rays, at, out) {
                        counts.heights += found.heights;
                        counts.bounds += found.bounds;
                        counts.steps += found.steps;
                        break;
                    }
                    for row in along + slabs.len()..(along + needed).min(rows) {
                        let (near_strip, near_phase) = places[row];
                        slabs.push(slab(phase, near_phase, places[row + 1].0 - near_strip, frame.shear));
                        let first = PAD as i64 - start + near_strip;
                        inside.push([first as isize, (first + across - 1) as isize]);
                    }
                }
            }
        }
        (mask, counts)
    }

    /// Row `along` of the heights; beyond the map its edge is repeated.
    fn load<H: Copy + Into<f32>>(&mut self, nodes: &PlaneNodes<'_, H>, frame: &Frame, along: usize, first: i64) {
        let across = frame.cells[1] as i64;
        let row = frame.origin as isize + along as isize * frame.strides[0];
        let out = &mut self.heights_m[along * STRIDE..][..STRIDE];
        let [begin, end] = [-first, STRIDE as i64 - first];
        if frame.strides[1] == 1 && begin >= 0 && end <= across + 1 {
            let samples = &nodes.samples[(row + begin as isize) as usize..][..STRIDE];
            for (out, &h) in out.iter_mut().zip(samples) {
                *out = h.into() * nodes.unit_m;
            }
            return;
        }
        for (out, node) in out.iter_mut().zip(begin..) {
            let at = row + node.clamp(0, across) as isize * frame.strides[1];
            *out = nodes.samples[at as usize].into() * nodes.unit_m;
        }
    }

    /// The bounds at a row line, from those of the next.
    fn bound(&mut self, along: usize, far: Option<Slab>, climb_m: f32) {
        let here = along * STRIDE;
        let Some(far) = far else {
            self.above_m[here..here + STRIDE].fill(DEEP);
            self.below_m[here..here + STRIDE].fill(DEEP);
            return;
        };
        let (above, next_above) = self.above_m[here..].split_at_mut(STRIDE);
        let (below, next_below) = self.below_m[here..].split_at_mut(STRIDE);
        let heights = [&self.heights_m[here..][..STRIDE], &self.heights_m[here + STRIDE..][..STRIDE]];
        bound_row(heights, [above, below], [next_above, next_below], &far, climb_m);
    }

    /// Strips that lie beyond the map, if only in part, stop no ray.
    fn clip(&mut self, along: usize, first: i64, phase: f64, across: i64) {
        let below = &mut self.below_m[along * STRIDE..][..STRIDE];
        // The strip at place k spans nodes k - first - phase to one more.
        let inner = [first + i64::from(phase > 0.0), first + across - 1];
        for (k, below) in (0..).zip(below.iter_mut()) {
            if k < inner[0] || k > inner[1] {
                *below = DEEP;
            }
        }
    }
}

fn lanes(values: &[f32], at: usize) -> Lanes {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&values[at..at + LANES]);
    out
}

/// Heights along the left side of each strip in a slab: at the near row line, and their maximum
/// less the climb.
#[inline(always)]
fn side(heights: [&[f32]; 2], far: &Slab, climb_m: f32, at: usize) -> [Lanes; 2] {
    let mut line = [0.0; LANES];
    let mut most = [DEEP; LANES];
    for (k, piece) in far.pieces[..far.count].iter().enumerate() {
        let [c0, c1, c2] = quadratic(heights, piece, climb_m, at);
        let bump = 0.25 * (piece.to - piece.from) * (piece.to - piece.from);
        for i in 0..LANES {
            let from = c0[i] + piece.from * (c1[i] + piece.from * c2[i]);
            let to = c0[i] + piece.to * (c1[i] + piece.to * c2[i]);
            most[i] = most[i].max(from.max(to) + bump * (-c2[i]).max(0.0));
            if k == 0 {
                line[i] = from;
            }
        }
    }
    [line, most]
}

/// The patch along a piece, less the climb, as a quadratic in the share of the slab.
#[inline(always)]
fn quadratic(heights: [&[f32]; 2], piece: &Piece, climb_m: f32, at: usize) -> [Lanes; 3] {
    let near = at.wrapping_add_signed(piece.near);
    let far = at.wrapping_add_signed(piece.far);
    let (h00, h10) = (lanes(heights[0], near), lanes(heights[0], near + 1));
    let (h01, h11) = (lanes(heights[1], far), lanes(heights[1], far + 1));
    let mut out = [[0.0; LANES]; 3];
    for i in 0..LANES {
        let (a, b) = (h10[i] - h00[i], h01[i] - h00[i]);
        let d = (h11[i] - h01[i]) - a;
        out[0][i] = h00[i] + piece.left * a;
        out[1][i] = piece.shear * a + b + piece.left * d - climb_m;
        out[2][i] = piece.shear * d;
    }
    out
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn bound_row(
    heights: [&[f32]; 2],
    [above, below]: [&mut [f32]; 2],
    [next_above, next_below]: [&[f32]; 2],
    far: &Slab,
    climb_m: f32,
) {
    for chunk in 0..BAND / LANES {
        let at = PAD + chunk * LANES;
        let [line, most] = side(heights, far, climb_m, at);
        let [next_line, next_most] = side(heights, far, climb_m, at + 1);
        let near = lanes(heights[0], at);
        let (up, down) = (lanes(next_above, at), lanes(next_below, at));
        // The node of the far row in the strip.
        let node = lanes(heights[1], at);
        for i in 0..LANES {
            let nodes = near[i].max(node[i] - climb_m);
            let slab = most[i].max(next_most[i]).max(nodes);
            // Twice the rounding of the difference.
            let slack = |m: f32| 2.0 * f32::EPSILON * (m.abs() + climb_m.abs());
            above[at + i] = slab.max(up[i] - climb_m + slack(up[i]));
            below[at + i] = line[i].min(next_line[i]).min(near[i]).max(down[i] - climb_m - slack(down[i]));
        }
    }
}

/// Casts the rays of [`LANES`] nodes of a row. None when more slabs are needed.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn cast<const COUNT: bool>(rays: &Rays<'_>, at: usize, out: &mut [u8]) -> Option<SweepCounts> {
    let band = rays.band;
    let start = lanes(&band.heights_m[rays.along * STRIDE..], at);
    let mut counts = SweepCounts::default();
    // 1 while a ray is on its way, and once it is stopped.
    let mut open = [1u32; LANES];
    let mut dark = [0u32; LANES];
    for k in 0.. {
        let row = rays.along + k;
        if row == rays.rows {
            break;
        }
        let rise_m = (k as f64 * rays.climb_m) as f32;
        let here = row * STRIDE;
        if k > 0 {
            let (above, below) = (lanes(&band.above_m[here..], at), lanes(&band.below_m[here..], at));
            if COUNT {
                counts.bounds += u64::from(open.iter().sum::<u32>());
            }
            let mut left = 0;
            for i in 0..LANES {
                let ray_m = start[i] + rise_m;
                dark[i] |= open[i] & u32::from(below[i] > ray_m);
                open[i] &= u32::from(above[i] > ray_m) & (dark[i] ^ 1);
                left |= open[i];
            }
            if left == 0 {
                break;
            }
        }
        let slab = rays.slabs.get(k)?;
        let [first, last] = *rays.inside.get(k)?;
        let heights = [&band.heights_m[here..][..STRIDE], &band.heights_m[here + STRIDE..][..STRIDE]];
        for piece in &slab.pieces[..slab.count] {
            let cell = at as isize + piece.near;
            if cell < first || cell + LANES as isize - 1 > last {
                for (i, open) in (cell..).zip(open.iter_mut()) {
                    *open &= u32::from(i >= first && i <= last);
                }
            }
            if COUNT {
                counts.heights += 4 * u64::from(open.iter().sum::<u32>());
            }
            let [c0, c1, c2] = quadratic(heights, piece, rays.climb_m as f32, at);
            let own = k == 0 && piece.from == 0.0;
            let [from, to] = [if own { rays.near } else { piece.from }, piece.to];
            if from > to {
                continue;
            }
            for i in 0..LANES {
                // In its own patch a ray starts at the patch's height.
                let base = if own { 0.0 } else { (c0[i] - start[i]) - rise_m };
                let value = |x: f32| base + x * (c1[i] + x * c2[i]);
                let peak = (c1[i] + 2.0 * from * c2[i] > 0.0)
                    & (c1[i] + 2.0 * to * c2[i] < 0.0)
                    & (c1[i] * c1[i] > 4.0 * base * c2[i]);
                dark[i] |= open[i] & u32::from((value(from) > 0.0) | (value(to) > 0.0) | peak);
            }
            for i in 0..LANES {
                open[i] &= dark[i] ^ 1;
            }
        }
        if COUNT {
            counts.steps += u64::from(open.iter().sum::<u32>());
        }
    }
    for (out, dark) in out.iter_mut().zip(dark) {
        *out = 1 - dark as u8;
    }
    Some(counts)
}
