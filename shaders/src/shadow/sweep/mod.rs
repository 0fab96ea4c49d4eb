//! All nodes of a plane at once, exactly.
//!
//! Rays of one sun are parallel, so in coordinates sheared along the sun's azimuth each keeps to
//! its column. The map is cut into strips one cell wide along the rays; from the far end on, each
//! strip learns at every row line the least height above which every ray in it is free (`above`)
//! and the greatest height below which every ray in it is stopped (`below`). A node's ray crosses
//! patches exactly, as `exact` does, only until one of the two decides: one to three rows, for
//! sixteen neighbours in step, since all nodes of a row meet the same fractions of cells.
//!
//! Memory: the nodes, the mask (twice where the rays go along the map's rows), and two floats a row and strip of a band of each thread.

mod band;
mod cast;
mod disk;
mod lanes;
mod slab;

use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;

use band::{BAND, Band};
pub use disk::sweep_disk;

/// Nodes of a plane in rows from the south; heights are (samples + `base`) times `unit_m`.
#[derive(Clone, Copy, Debug)]
pub struct PlaneNodes<'a, H> {
    /// (columns + 1) x (rows + 1) samples.
    pub samples: &'a [H],
    /// Added to a sample, in f32.
    pub base: f32,
    /// Metres of a sample.
    pub unit_m: f32,
    /// Cells eastwards.
    pub columns: usize,
    /// Cells northwards.
    pub rows: usize,
    /// Metres between nodes, eastwards and northwards.
    pub spacing_m: [f64; 2],
}

impl<H: Copy + Into<f32>> PlaneNodes<'_, H> {
    /// The height that a sample stands for, metres.
    #[inline(always)]
    pub(crate) fn height_m(&self, sample: H) -> f32 {
        (sample.into() + self.base) * self.unit_m
    }
}

/// What a sweep fetched, in all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepCounts {
    /// Heights that rays read: four for a patch.
    pub heights: u64,
    /// Pairs of strip bounds that rays read.
    pub bounds: u64,
    /// Rows that rays crossed.
    pub steps: u64,
}

/// Which nodes of a plane see the sun (unit vector east, north, up): 1 lit, 0 in shadow, columns x
/// rows, south row first. `COUNT` makes it count its fetches, at the cost of time.
///
/// # Panics
/// When the number of samples is not that of the grid.
#[must_use]
pub fn sweep_mask<const COUNT: bool, H: Copy + Into<f32> + Sync>(
    nodes: &PlaneNodes<'_, H>,
    sun: [f32; 3],
) -> (Vec<u8>, SweepCounts) {
    assert_eq!(nodes.samples.len(), (nodes.columns + 1) * (nodes.rows + 1), "samples of the plane");
    let Some(frame) = Frame::new(nodes, sun) else {
        // At the zenith nothing shades; from below everything is dark.
        return (vec![u8::from(sun[2] > 0.0); nodes.columns * nodes.rows], SweepCounts::default());
    };
    let [low, high] = frame.strips();
    let starts: Vec<i64> = (low..=high).step_by(BAND).collect();
    // Each band stores its own nodes, which are no slice of the mask.
    let mask: Vec<AtomicU8> = (0..nodes.columns * nodes.rows).map(|_| AtomicU8::new(1)).collect();
    let counts = starts
        .par_iter()
        .map_init(Band::default, |band, &start| band.shade::<COUNT, H>(nodes, &frame, start, &mask))
        .reduce(SweepCounts::default, |a, b| SweepCounts {
            heights: a.heights + b.heights,
            bounds: a.bounds + b.bounds,
            steps: a.steps + b.steps,
        });
    // In place: the same bytes.
    let mask = mask.into_iter().map(AtomicU8::into_inner).collect();
    (if frame.rows_are_rows { mask } else { transposed(&mask, nodes.rows) }, counts)
}

/// The map as a sun sees it: `along` counts rows of nodes towards the sun, `across` the other axis.
struct Frame {
    /// Cells along and across.
    cells: [usize; 2],
    /// Samples from one node to the next, along and across.
    strides: [isize; 2],
    /// Sample of node (0, 0).
    origin: usize,
    /// Across is east: rows of the map are rows of the frame.
    rows_are_rows: bool,
    /// Along counts against the map's axis.
    reversed: bool,
    /// Cells across that a ray moves in a row, -1 to 1.
    shear: f64,
    /// Metres that a ray climbs in a row.
    climb_m: f64,
    /// Share of a row that is too near to shade: a hundredth of a cell of the ray's length.
    near: f32,
    /// More than the rounding of a level, metres.
    slack_m: f32,
}

impl Frame {
    /// None for a sun without azimuth.
    fn new<H: Copy + Into<f32> + Sync>(nodes: &PlaneNodes<'_, H>, sun: [f32; 3]) -> Option<Self> {
        let [east, north, up] = sun.map(f64::from);
        let [x, y] = [east / nodes.spacing_m[0], north / nodes.spacing_m[1]];
        let (columns, rows) = (nodes.columns, nodes.rows);
        let stride = columns as isize + 1;
        let rows_are_rows = y.abs() >= x.abs();
        let [forward, sideways] = if rows_are_rows { [y, x] } else { [x, y] };
        if forward.abs() * (columns + rows) as f64 * nodes.spacing_m[0].max(nodes.spacing_m[1]) < 1e-7 {
            return None;
        }
        let reversed = forward < 0.0;
        let high = nodes.samples.par_iter().map(|&h| nodes.height_m(h).abs()).reduce(|| 0.0, f32::max);
        let climb_m = up / forward.abs();
        let (cells, strides) =
            if rows_are_rows { ([rows, columns], [stride, 1]) } else { ([columns, rows], [1, stride]) };
        Some(Self {
            cells,
            strides: [if reversed { -strides[0] } else { strides[0] }, strides[1]],
            origin: if reversed { cells[0] * strides[0] as usize } else { 0 },
            rows_are_rows,
            reversed,
            shear: sideways / forward.abs(),
            climb_m,
            slack_m: 3.0 * f32::EPSILON * (high + (climb_m.abs() * cells[0] as f64) as f32),
            near: (0.01 * nodes.spacing_m[0].min(nodes.spacing_m[1]) * forward.abs()) as f32,
        })
    }

    /// First and last strip that holds a node.
    fn strips(&self) -> [i64; 2] {
        let slip = self.cells[0] as f64 * self.shear;
        [(-slip).min(0.0).floor() as i64 - 1, self.cells[1] as i64 + (-slip).max(0.0).ceil() as i64 + 1]
    }

    /// The strip of node 0 across in a row, and the share of the strip on its left.
    fn row(&self, along: usize) -> (i64, f64) {
        let place = -(along as f64) * self.shear;
        let strip = place.floor();
        (strip as i64, place - strip)
    }

    /// Stores the light of the nodes of a row, those of the strips from `start` on; the mask's rows are
    /// the frame's.
    fn store(&self, mask: &[AtomicU8], along: usize, start: i64, lit: &[u8]) {
        let along_map = if self.reversed { self.cells[0] - along } else { along };
        if along_map == self.cells[0] {
            return;
        }
        let node = start - self.row(along).0;
        let skipped = (-node).clamp(0, lit.len() as i64) as usize;
        let across = (node + skipped as i64) as usize;
        let count = self.cells[1].saturating_sub(across).min(lit.len() - skipped);
        if count == 0 {
            return;
        }
        let places = &mask[along_map * self.cells[1] + across..];
        for (place, &lit) in places.iter().zip(&lit[skipped..][..count]) {
            place.store(lit, Ordering::Relaxed);
        }
    }
}

/// Columns as rows, for rows of `width` values.
fn transposed(values: &[u8], width: usize) -> Vec<u8> {
    /// Columns that are read at once.
    const TOGETHER: usize = 32;
    let height = values.len() / width;
    let mut out = vec![0; values.len()];
    out.par_chunks_mut(height * TOGETHER).enumerate().for_each(|(k, out)| {
        let first = k * TOGETHER;
        for (row, values) in values.chunks_exact(width).enumerate() {
            let columns = values[first..].iter().take(TOGETHER);
            columns.zip(out[row..].iter_mut().step_by(height)).for_each(|(&value, out)| *out = value);
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_become_rows() {
        let (width, height) = (70, 3);
        let values: Vec<u8> = (0..width * height).map(|k| k as u8).collect();
        let turned = transposed(&values, width);
        assert!((0..width * height).all(|k| turned[k % width * height + k / width] == values[k]));
        assert!(turned != values && transposed(&turned, height) == values);
    }
}
