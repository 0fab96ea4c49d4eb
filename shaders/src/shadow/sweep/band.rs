//! A band of strips, from the far end of the map to the near one.
//!
//! Heights are told less the climb of a ray up to their row, so that a ray keeps one height, its
//! `level`, all the way.

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
/// Rows that are passed at once where no strip reaches a ray.
const BLOCK: usize = 16;
/// A height below all relief, metres.
const DEEP: f32 = -1.0e30;

type Lanes = [f32; LANES];

/// The buffers of a band, reused from one to the next; [`STRIDE`] values a row.
#[derive(Default)]
pub struct Band {
    /// Heights of the nodes, metres.
    heights_m: Vec<f32>,
    /// Greatest level of the relief in a strip, from a row line to the next.
    greatest_m: Vec<f32>,
    /// The same over a block of rows.
    block_m: Vec<f32>,
    /// The same from the start of a block of rows to the end of the map.
    rest_m: Vec<f32>,
    /// The same from the row line last done to the end of the map.
    above_m: Vec<f32>,
    /// A level that in every part of the strip some relief ahead reaches.
    below_m: Vec<f32>,
}

/// The rays of a row.
struct Rays<'a> {
    band: &'a Band,
    frame: &'a Frame,
    along: usize,
    /// The slabs ahead, nearest first, as far as a ray has needed them.
    ahead: &'a [Ahead],
}

/// A slab, and the first and last place whose cell is on the map.
#[derive(Clone, Copy, Debug)]
struct Ahead {
    slab: Slab,
    inside: [isize; 2],
}

impl Band {
    /// Shades the nodes of the strips from `start` on: [`BAND`] bytes a row, 1 lit, 0 in shadow.
    pub fn shade<const COUNT: bool, H: Copy + Into<f32>>(
        &mut self,
        nodes: &PlaneNodes<'_, H>,
        frame: &Frame,
        start: i64,
    ) -> (Vec<u8>, SweepCounts) {
        let (rows, across) = (frame.cells[0], frame.cells[1] as i64);
        self.clear(rows);
        let mut mask = vec![1; (rows + 1) * BAND];
        let mut counts = SweepCounts::default();
        let places: Vec<(i64, f64)> = (0..=rows).map(|along| frame.row(along)).collect();
        // Place k of a row holds the node k - first across.
        let first = |along: usize| PAD as i64 - start + places[along].0;
        let slab_at = |phase: f64, along: usize| {
            let (strip, near_phase) = places[along];
            slab(phase, near_phase, places[along + 1].0 - strip, frame.shear)
        };
        let mut ahead: Vec<Ahead> = Vec::new();
        for along in (0..=rows).rev() {
            let first_here = first(along);
            self.load(nodes, frame, along, first_here);
            if along == rows || first_here > (BAND + PAD) as i64 || first_here + across < PAD as i64 {
                continue;
            }
            let phase = places[along].1;
            ahead.clear();
            for chunk in 0..BAND / LANES {
                let at = PAD + chunk * LANES;
                let out = &mut mask[along * BAND + chunk * LANES..][..LANES];
                // The bounds are still those of the next row line.
                while let Err(needed) =
                    cast::<COUNT>(&Rays { band: self, frame, along, ahead: &ahead }, at, out, &mut counts)
                {
                    for row in along + ahead.len()..(along + needed + 8).min(rows) {
                        let first = first(row) as isize;
                        ahead.push(Ahead { slab: slab_at(phase, row), inside: [first, first + across as isize - 1] });
                    }
                }
            }
            let far = slab_at(0.0, along);
            self.bound(along, &far, frame);
            // Strips beyond the map hold no relief; those beyond in part do not stop every ray.
            let [begin, end] = [first_here, first_here + across];
            let row = along * STRIDE..(along + 1) * STRIDE;
            clip(&mut self.greatest_m[row], [begin, end]);
            clip(&mut self.below_m, [begin + i64::from(phase > 0.0), end - 1]);
            self.collect(along);
        }
        (mask, counts)
    }

    fn clear(&mut self, rows: usize) {
        let size = (rows + 1) * STRIDE;
        let blocks = (rows / BLOCK + 1) * STRIDE;
        for (buffer, size) in [
            (&mut self.heights_m, size),
            (&mut self.greatest_m, size),
            (&mut self.block_m, blocks),
            (&mut self.rest_m, blocks),
            (&mut self.above_m, STRIDE),
            (&mut self.below_m, STRIDE),
        ] {
            buffer.clear();
            buffer.resize(size, DEEP);
        }
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

    /// `greatest_m` of a slab, and what the strips reach from its near row line on.
    fn bound(&mut self, along: usize, far: &Slab, frame: &Frame) {
        let here = along * STRIDE;
        let heights = [&self.heights_m[here..][..STRIDE], &self.heights_m[here + STRIDE..][..STRIDE]];
        let base_m = (along as f64 * frame.climb_m) as f32;
        let greatest = &mut self.greatest_m[here..][..STRIDE];
        bound_row(heights, far, [frame.climb_m as f32, base_m, frame.slack_m], greatest, &mut self.below_m);
    }

    /// Takes a slab into the maxima of its block and of the rest.
    fn collect(&mut self, along: usize) {
        let greatest = &self.greatest_m[along * STRIDE..][..STRIDE];
        let block = &mut self.block_m[along / BLOCK * STRIDE..][..STRIDE];
        for ((above, block), &m) in self.above_m.iter_mut().zip(block.iter_mut()).zip(greatest) {
            *above = above.max(m);
            *block = block.max(m);
        }
        if along.is_multiple_of(BLOCK) {
            self.rest_m[along / BLOCK * STRIDE..][..STRIDE].copy_from_slice(&self.above_m);
        }
    }
}

/// Empties the places outside `first..=last`.
fn clip(row: &mut [f32], [first, last]: [i64; 2]) {
    if first > 0 || last < STRIDE as i64 - 1 {
        for (k, value) in (0..).zip(row.iter_mut()) {
            if k < first || k > last {
                *value = DEEP;
            }
        }
    }
}

#[inline(always)]
fn lanes(values: &[f32], at: usize) -> Lanes {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&values[at..at + LANES]);
    out
}

/// The patch along a piece, less the climb in the slab, as a quadratic in the share of the slab.
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

/// Heights along the left side of each strip: at the near row line, and the greatest of the slab
/// less the climb in it.
#[inline(always)]
fn side(heights: [&[f32]; 2], far: &Slab, climb_m: f32, at: usize) -> [Lanes; 2] {
    let mut line = [0.0; LANES];
    let mut most = [DEEP; LANES];
    for (k, piece) in far.pieces[..far.count].iter().enumerate() {
        let [c0, c1, c2] = quadratic(heights, piece, climb_m, at);
        // A parabola rises above its chord by no more.
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

/// In a strip the patches are greatest on its sides or at its nodes, and least on a row line at
/// one of the three.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn bound_row(
    heights: [&[f32]; 2],
    far: &Slab,
    [climb_m, base_m, slack_m]: [f32; 3],
    greatest: &mut [f32],
    below: &mut [f32],
) {
    for chunk in 0..BAND / LANES {
        let at = PAD + chunk * LANES;
        let [line, most] = side(heights, far, climb_m, at);
        let [next_line, next_most] = side(heights, far, climb_m, at + 1);
        let (near, node) = (lanes(heights[0], at), lanes(heights[1], at));
        let old = lanes(below, at);
        for i in 0..LANES {
            let top = most[i].max(next_most[i]).max(near[i].max(node[i] - climb_m));
            greatest[at + i] = top - base_m + slack_m;
            below[at + i] = old[i].max(line[i].min(next_line[i]).min(near[i]) - base_m - slack_m);
        }
    }
}

/// Casts the rays of [`LANES`] nodes of a row; with an error when that many slabs are needed.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn cast<const COUNT: bool>(rays: &Rays<'_>, at: usize, out: &mut [u8], counts: &mut SweepCounts) -> Result<(), usize> {
    let Rays { band, frame, along, ahead } = *rays;
    let rows = frame.cells[0];
    let start = lanes(&band.heights_m[along * STRIDE..], at);
    let base_m = (along as f64 * frame.climb_m) as f32;
    let mut found = SweepCounts::default();
    let mut level = [0.0; LANES];
    // 1 while a ray is on its way, and once it is stopped.
    let mut open = [1u32; LANES];
    let mut dark = [0u32; LANES];
    for i in 0..LANES {
        level[i] = start[i] - base_m;
    }
    let mut row = along;
    while row < rows {
        let k = row - along;
        if k > 0 {
            if k == 1 || row % BLOCK == 0 {
                let block = row / BLOCK * STRIDE;
                let rest = if k == 1 { lanes(&band.above_m, at) } else { lanes(&band.rest_m[block..], at) };
                let below = if k == 1 { lanes(&band.below_m, at) } else { [DEEP; LANES] };
                let mut left = 0;
                for i in 0..LANES {
                    dark[i] |= open[i] & u32::from(below[i] > level[i]);
                    open[i] &= u32::from(rest[i] > level[i]) & (dark[i] ^ 1);
                    left |= open[i];
                }
                if COUNT {
                    found.bounds += u64::from(open.iter().sum::<u32>());
                }
                if left == 0 {
                    break;
                }
                if row % BLOCK == 0 && !reached(&band.block_m[block..], at, &level, &open) {
                    row += BLOCK;
                    continue;
                }
            }
            if COUNT {
                found.bounds += u64::from(open.iter().sum::<u32>());
            }
            if !reached(&band.greatest_m[row * STRIDE..], at, &level, &open) {
                row += 1;
                continue;
            }
        }
        let Some(Ahead { slab, inside }) = ahead.get(k) else { return Err(k) };
        let here = row * STRIDE;
        let heights = [&band.heights_m[here..][..STRIDE], &band.heights_m[here + STRIDE..][..STRIDE]];
        let rise_m = (k as f64 * frame.climb_m) as f32;
        for piece in &slab.pieces[..slab.count] {
            let cell = at as isize + piece.near;
            if cell < inside[0] || cell + LANES as isize - 1 > inside[1] {
                for (cell, open) in (cell..).zip(open.iter_mut()) {
                    *open &= u32::from(cell >= inside[0] && cell <= inside[1]);
                }
            }
            let own = k == 0 && piece.from == 0.0;
            let [from, to] = [if own { frame.near } else { piece.from }, piece.to];
            if from > to {
                continue;
            }
            if COUNT {
                found.heights += 4 * u64::from(open.iter().sum::<u32>());
            }
            let [c0, c1, c2] = quadratic(heights, piece, frame.climb_m as f32, at);
            for i in 0..LANES {
                // In its own patch a ray starts at the patch's height.
                let base = if own { 0.0 } else { (c0[i] - start[i]) - rise_m };
                let value = |x: f32| base + x * (c1[i] + x * c2[i]);
                let peak = (c1[i] + 2.0 * from * c2[i] > 0.0)
                    & (c1[i] + 2.0 * to * c2[i] < 0.0)
                    & (c1[i] * c1[i] > 4.0 * base * c2[i]);
                dark[i] |= open[i] & u32::from((value(from) > 0.0) | (value(to) > 0.0) | peak);
                open[i] &= dark[i] ^ 1;
            }
        }
        if COUNT {
            found.steps += u64::from(open.iter().sum::<u32>());
        }
        row += 1;
    }
    for (out, dark) in out.iter_mut().zip(dark) {
        *out = 1 - dark as u8;
    }
    if COUNT {
        counts.heights += found.heights;
        counts.bounds += found.bounds;
        counts.steps += found.steps;
    }
    Ok(())
}

/// Whether a strip reaches a ray that is on its way.
#[inline(always)]
fn reached(greatest: &[f32], at: usize, level: &Lanes, open: &[u32; LANES]) -> bool {
    let greatest = lanes(greatest, at);
    let mut any = 0;
    for i in 0..LANES {
        any |= open[i] & u32::from(greatest[i] > level[i]);
    }
    any != 0
}
