//! The rays of neighbouring nodes, in step.

use multiversion::multiversion;

use super::band::{BLOCK, Band, STRIDE};
use super::lanes::{DEEP, LANES, Lanes, lanes, quadratic};
use super::slab::Slab;
use super::{Frame, SweepCounts};

/// The rays of a row.
pub struct Rays<'a> {
    /// The band.
    pub band: &'a Band,
    /// The map.
    pub frame: &'a Frame,
    /// The row.
    pub along: usize,
    /// The slabs ahead, nearest first, as far as a ray has needed them.
    pub ahead: &'a [Ahead],
}

/// A slab, and the first and last place whose cell is on the map.
#[derive(Clone, Copy, Debug)]
pub struct Ahead {
    /// The slab.
    pub slab: Slab,
    /// First and last place whose cell is on the map.
    pub inside: [isize; 2],
}

/// Casts the rays of [`LANES`] nodes of a row; with an error when that many slabs are needed.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn cast<const COUNT: bool>(
    rays: &Rays<'_>,
    at: usize,
    out: &mut [u8],
    counts: &mut SweepCounts,
) -> Result<(), usize> {
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
