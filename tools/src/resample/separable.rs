//! Sampling where columns are meridians and rows parallels: taps per column and per row, then
//! whole rows at a time.

use super::axis::Axis;
use super::kernel::Kernel;
use crate::source::raster::{Patch, Raster};
use relief_front::error::ToolError;

/// Most pixels copied out of a raster at a time.
const PATCH_PIXELS: usize = 1 << 21;

/// Taps of rows whose kernels differ, at least: so many go through the loop that leaves out taps
/// without weight, and a row's sum does not depend on the kernels of the rows around it.
const MIXED_TAPS: usize = 5;

/// A raster's pixels and axes.
#[derive(Clone, Copy)]
pub(crate) struct Separable<'a> {
    pub raster: &'a Raster,
    pub columns: &'a Axis,
    pub rows: &'a Axis,
    /// Whether kernels may differ from row to row.
    pub mixed_rows: bool,
}

/// What one position on an axis is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Position {
    /// Sample coordinate of the position itself: its pixel decides whether it is void.
    pub at: f64,
    /// Sample coordinate in the middle of the kernel.
    pub centre: f64,
    pub kernel: Kernel,
}

/// The taps of a list of positions on one axis.
pub(crate) struct Taps {
    /// Taps of each position, and of its fallback.
    many: usize,
    few: usize,
    /// For each tap list: kernel's first tap, fallback's first tap, the containing pixel.
    starts: Vec<[i64; 3]>,
    weights: Vec<f64>,
    fallback: Vec<f64>,
    /// Index of each position in the lists above; none outside the raster.
    slots: Vec<Option<u32>>,
}

impl Position {
    /// A position in the middle of its kernel.
    pub fn new(u: f64, kernel: Kernel) -> Self {
        Self { at: u, centre: u, kernel }
    }
}

impl Taps {
    /// Taps of positions (none outside the raster), `least` of each or more.
    pub fn new(axis: &Axis, positions: &[Option<Position>], least: usize) -> Self {
        let most = |taps: fn(Kernel) -> usize| positions.iter().flatten().map(|p| taps(p.kernel)).max().unwrap_or(1);
        let (many, few) = (most(Kernel::taps).max(least), most(|kernel| kernel.fallback().taps()));
        let count = positions.iter().flatten().count();
        let (mut weights, mut fallback) = (vec![0.0; count * many], vec![0.0; count * few]);
        let mut starts = Vec::with_capacity(count);
        let mut slots = Vec::with_capacity(positions.len());
        for position in positions {
            slots.push(position.map(|Position { at, centre, kernel }| {
                let slot = starts.len();
                let spare = kernel.fallback();
                starts.push([kernel.start(axis, centre), spare.start(axis, centre), axis.home(at)]);
                kernel.weigh(axis, centre, &mut weights[slot * many..][..kernel.taps()]);
                spare.weigh(axis, centre, &mut fallback[slot * few..][..spare.taps()]);
                slot as u32
            }));
        }
        Self { many, few, starts, weights, fallback, slots }
    }

    /// Positions, those outside the raster included.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    fn slots_in(&self, range: std::ops::Range<usize>) -> Vec<(usize, usize)> {
        range.filter_map(|at| self.slots[at].map(|slot| (at, slot as usize))).collect()
    }

    /// All sample indices that the positions `used` touch, ascending.
    fn touched(&self, used: &[(usize, usize)]) -> Vec<i64> {
        let many = self.many as i64;
        let mut touched: Vec<i64> = Vec::with_capacity(used.len() * 2);
        let mut stretches: Vec<i64> = used.iter().map(|&(_, slot)| self.starts[slot][0]).collect();
        stretches.sort_unstable();
        for start in stretches {
            let from = touched.last().map_or(start, |last| start.max(last + 1));
            touched.extend(from..start + many);
        }
        touched
    }
}

impl Separable<'_> {
    /// Heights at every combination of `rows` (none outside the raster) and the positions of
    /// `columns`, row by row into `heights_m`: metres, NaN where void.
    ///
    /// # Errors
    /// Those of reading the raster.
    pub fn sample(&self, columns: &Taps, rows: &[Option<Position>], heights_m: &mut [f64]) -> Result<(), ToolError> {
        let taps = Taps::new(self.rows, rows, if self.mixed_rows { MIXED_TAPS } else { 1 });
        self.sample_part(columns, &taps, 0..columns.len(), 0..rows.len(), heights_m)
    }

    fn sample_part(
        &self,
        columns: &Taps,
        rows: &Taps,
        x_range: std::ops::Range<usize>,
        y_range: std::ops::Range<usize>,
        heights_m: &mut [f64],
    ) -> Result<(), ToolError> {
        let (xs, ys) = (columns.slots_in(x_range.clone()), rows.slots_in(y_range.clone()));
        if xs.is_empty() || ys.is_empty() {
            return Ok(());
        }
        let (touched_x, touched_y) = (columns.touched(&xs), rows.touched(&ys));
        if touched_x.len() * touched_y.len() > PATCH_PIXELS && (ys.len() > 1 || xs.len() > 1) {
            let halves = |range: &std::ops::Range<usize>| {
                let middle = range.start + range.len() / 2;
                (range.start..middle, middle..range.end)
            };
            if y_range.len() > 1 {
                let (south, north) = halves(&y_range);
                self.sample_part(columns, rows, x_range.clone(), south, heights_m)?;
                return self.sample_part(columns, rows, x_range, north, heights_m);
            }
            let (west, east) = halves(&x_range);
            self.sample_part(columns, rows, west, y_range.clone(), heights_m)?;
            return self.sample_part(columns, rows, east, y_range, heights_m);
        }
        let stored_x: Vec<_> = touched_x.iter().map(|&x| self.columns.stored(x).0).collect();
        let stored_y: Vec<_> = touched_y.iter().map(|&y| self.rows.stored(y)).collect();
        let patch = self.raster.gather(&stored_y, &stored_x, self.columns.period)?;
        // Where each position's taps begin within the patch.
        let begin = |touched: &[i64], starts: [i64; 3]| {
            let at = touched.partition_point(|&index| index < starts[0]);
            [at, at + (starts[1] - starts[0]) as usize, at + (starts[2] - starts[0]) as usize]
        };
        let at_x: Vec<_> = xs.iter().map(|&(_, slot)| begin(&touched_x, columns.starts[slot])).collect();
        let stride = columns.slots.len();
        let mut mixed = vec![0.0; patch.nx];
        let mut line = vec![0.0; xs.len()];
        // Positions inside the raster usually are one stretch: then their weights are, too.
        let weights: Vec<f64> = {
            let many = columns.many;
            xs.iter().flat_map(|&(_, slot)| &columns.weights[slot * many..][..many]).copied().collect()
        };
        let starts: Vec<u32> = at_x.iter().map(|begin| begin[0] as u32).collect();
        for &(y, row_slot) in &ys {
            let at_y = begin(&touched_y, rows.starts[row_slot]);
            let many = rows.many;
            mix_rows(&patch.pixels[at_y[0] * patch.nx..], &rows.weights[row_slot * many..][..many], &mut mixed);
            match columns.many {
                1 => mix_columns::<1>(&mixed, &starts, &weights, &mut line),
                2 => mix_columns::<2>(&mixed, &starts, &weights, &mut line),
                4 => mix_columns::<4>(&mixed, &starts, &weights, &mut line),
                6 => mix_columns::<6>(&mixed, &starts, &weights, &mut line),
                taps => mix_columns_wide(&mixed, &starts, taps, &weights, &mut line),
            }
            let out = &mut heights_m[y * stride..][..stride];
            for (at, (&(x, slot), height)) in xs.iter().zip(&line).enumerate() {
                out[x] = match height.is_nan() {
                    false => *height,
                    true => beside_voids(&patch, at_x[at], at_y, fallback(columns, slot), fallback(rows, row_slot)),
                };
            }
        }
        Ok(())
    }
}

fn fallback(taps: &Taps, slot: usize) -> &[f64] {
    &taps.fallback[slot * taps.few..][..taps.few]
}

/// Height where a tap is void: none if the containing pixel is, else the fallback kernel over
/// the pixels that are not, their weights made to sum to 1.
pub(crate) fn beside_voids(patch: &Patch, x: [usize; 3], y: [usize; 3], wx: &[f64], wy: &[f64]) -> f64 {
    if patch.pixels[y[2] * patch.nx + x[2]].is_nan() {
        return f64::NAN;
    }
    let (mut sum, mut total) = (0.0, 0.0);
    for (row, wy) in wy.iter().enumerate().filter(|(_, w)| **w != 0.0) {
        let line = &patch.pixels[(y[1] + row) * patch.nx + x[1]..];
        for (pixel, wx) in line.iter().zip(wx).filter(|(_, w)| **w != 0.0) {
            if !pixel.is_nan() {
                sum += wx * wy * f64::from(*pixel);
                total += wx * wy;
            }
        }
    }
    sum / total
}

/// Weighted sum of the first `weights.len()` rows of `pixels`.
#[multiversion::multiversion(targets("x86_64+avx2", "aarch64+neon"))]
fn mix_rows(pixels: &[f32], weights: &[f64], mixed: &mut [f64]) {
    let nx = mixed.len();
    match *weights {
        [_] => {
            for (out, p) in mixed.iter_mut().zip(&pixels[..nx]) {
                *out = f64::from(*p);
            }
        }
        [a, b] => {
            let (p, q) = (&pixels[..nx], &pixels[nx..2 * nx]);
            for i in 0..nx {
                mixed[i] = a * f64::from(p[i]) + b * f64::from(q[i]);
            }
        }
        [a, b, c, d] => {
            let (p, q, r, s) = (&pixels[..nx], &pixels[nx..2 * nx], &pixels[2 * nx..3 * nx], &pixels[3 * nx..4 * nx]);
            for i in 0..nx {
                mixed[i] = a * f64::from(p[i]) + b * f64::from(q[i]) + (c * f64::from(r[i]) + d * f64::from(s[i]));
            }
        }
        _ => {
            mixed.fill(0.0);
            for (line, weight) in pixels.chunks_exact(nx).zip(weights) {
                // A box's spare tap has no weight, and must not bring in a void.
                if *weight != 0.0 {
                    for (out, p) in mixed.iter_mut().zip(line) {
                        *out += weight * f64::from(*p);
                    }
                }
            }
        }
    }
}

/// Weighted sums of K neighbours from each start.
#[multiversion::multiversion(targets("x86_64+avx2", "aarch64+neon"))]
fn mix_columns<const K: usize>(mixed: &[f64], starts: &[u32], weights: &[f64], line: &mut [f64]) {
    for ((out, start), weights) in line.iter_mut().zip(starts).zip(weights.chunks_exact(K)) {
        let taps = &mixed[*start as usize..][..K];
        let mut sum = 0.0;
        for k in 0..K {
            sum += weights[k] * taps[k];
        }
        *out = sum;
    }
}

/// [`mix_columns`] for any number of taps.
#[multiversion::multiversion(targets("x86_64+avx2", "aarch64+neon"))]
fn mix_columns_wide(mixed: &[f64], starts: &[u32], taps: usize, weights: &[f64], line: &mut [f64]) {
    for ((out, start), weights) in line.iter_mut().zip(starts).zip(weights.chunks_exact(taps)) {
        let values = &mixed[*start as usize..][..taps];
        *out = values.iter().zip(weights).filter(|(_, w)| **w != 0.0).map(|(v, w)| v * w).sum();
    }
}
