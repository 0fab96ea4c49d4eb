//! A band of strips, from the far end of the map to the near one.
//!
//! Heights are told less the climb of a ray up to their row, so that a ray keeps one height, its
//! `level`, all the way.

use std::sync::atomic::AtomicU8;

use super::cast::{Ahead, Rays, cast};
use super::lanes::{DEEP, LANES, bound_row};
use super::slab::{Slab, slab};
use super::{Frame, PlaneNodes, SweepCounts};

/// Strips of a band.
pub const BAND: usize = 128;
/// Strips beside a band whose heights are kept: a ray's patches lie up to three strips away.
const PAD: usize = 4;
/// Values kept a row.
pub const STRIDE: usize = BAND + 2 * PAD;
/// Rows that are passed at once where no strip reaches a ray.
pub const BLOCK: usize = 16;

/// The buffers of a band, reused from one to the next; [`STRIDE`] values a row.
#[derive(Default)]
pub struct Band {
    /// Heights of the nodes, metres.
    pub heights_m: Vec<f32>,
    /// Greatest level of the relief in a strip, from a row line to the next.
    pub greatest_m: Vec<f32>,
    /// The same over a block of rows.
    pub block_m: Vec<f32>,
    /// The same from the start of a block of rows to the end of the map.
    pub rest_m: Vec<f32>,
    /// The same from the row line last done to the end of the map.
    pub above_m: Vec<f32>,
    /// A level that in every part of the strip some relief ahead reaches.
    pub below_m: Vec<f32>,
}

impl Band {
    /// Shades the nodes of the strips from `start` on: 1 lit, 0 in shadow. What the mask holds of the
    /// far edge stays.
    pub fn shade<const COUNT: bool, H: Copy + Into<f32>>(
        &mut self,
        nodes: &PlaneNodes<'_, H>,
        frame: &Frame,
        start: i64,
        mask: &[AtomicU8],
    ) -> SweepCounts {
        let (rows, across) = (frame.cells[0], frame.cells[1] as i64);
        self.clear(rows);
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
            let mut lit = [1; BAND];
            for chunk in 0..BAND / LANES {
                let at = PAD + chunk * LANES;
                let out = &mut lit[chunk * LANES..][..LANES];
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
            frame.store(mask, along, start, &lit);
            let far = slab_at(0.0, along);
            self.bound(along, &far, frame);
            // Strips beyond the map hold no relief; those beyond in part do not stop every ray.
            let [begin, end] = [first_here, first_here + across];
            let row = along * STRIDE..(along + 1) * STRIDE;
            clip(&mut self.greatest_m[row], [begin, end]);
            clip(&mut self.below_m, [begin + i64::from(phase > 0.0), end - 1]);
            self.collect(along);
        }
        counts
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
                *out = nodes.height_m(h);
            }
            return;
        }
        for (out, node) in out.iter_mut().zip(begin..) {
            let at = row + node.clamp(0, across) as isize * frame.strides[1];
            *out = nodes.height_m(nodes.samples[at as usize]);
        }
    }

    /// `greatest_m` of a slab, and what the strips reach from its near row line on.
    fn bound(&mut self, along: usize, far: &Slab, frame: &Frame) {
        let here = along * STRIDE;
        let heights = [&self.heights_m[here..][..STRIDE], &self.heights_m[here + STRIDE..][..STRIDE]];
        let base_m = (along as f64 * frame.climb_m) as f32;
        let greatest = &mut self.greatest_m[here..][..STRIDE];
        bound_row(
            [PAD, BAND],
            heights,
            far,
            [frame.climb_m as f32, base_m, frame.slack_m],
            greatest,
            &mut self.below_m,
        );
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
