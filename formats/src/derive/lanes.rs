//! Cells side by side in the innermost index of arrays, for a compiler to vectorise over.

use super::interval::Interval;

/// Cells worked on at once.
pub(super) const LANES: usize = 16;
/// Levels between the nodes that are looked at and the level of a deviation, at most.
pub(super) const SPAN: u32 = 3;
/// n at most.
pub(super) const N: usize = 1 << SPAN;

pub(super) type Lanes = [i32; LANES];

/// The arrays of one run of [`LANES`] cells, reused from run to run.
pub(super) struct Scratch {
    /// Node heights, [row][column][cell].
    pub(super) nodes: Box<[[Lanes; 2 * N + 1]; 2 * N + 1]>,
    /// Lower bounds of S_0 - S_g, [row][column][cell].
    pub(super) lo: Box<[[Lanes; 2 * N]; 2 * N]>,
    /// Upper bounds.
    pub(super) hi: Box<[[Lanes; 2 * N]; 2 * N]>,
    /// Lower bounds of 16 S_0.
    pub(super) min: Box<[[Lanes; 2 * N]; 2 * N]>,
    /// Upper bounds.
    pub(super) max: Box<[[Lanes; 2 * N]; 2 * N]>,
    /// One quadrant's 16 (S_g - T) at its nodes, for the sides' mesh.
    pub(super) side: Box<[[Lanes; N + 1]; N + 1]>,
    /// The same for the centre's mesh.
    pub(super) centre: Box<[[Lanes; N + 1]; N + 1]>,
}

impl Scratch {
    pub(super) fn new() -> Self {
        let zero = [0; LANES];
        Self {
            nodes: Box::new([[zero; 2 * N + 1]; 2 * N + 1]),
            lo: Box::new([[zero; 2 * N]; 2 * N]),
            hi: Box::new([[zero; 2 * N]; 2 * N]),
            min: Box::new([[zero; 2 * N]; 2 * N]),
            max: Box::new([[zero; 2 * N]; 2 * N]),
            side: Box::new([[zero; N + 1]; N + 1]),
            centre: Box::new([[zero; N + 1]; N + 1]),
        }
    }
}

/// Deals a row of `size` columns a cell out to the cells' lanes; lanes without a cell keep what
/// they had, and nobody reads their results.
#[inline]
pub(super) fn spread(row: &[i32], size: usize, out: &mut [Lanes; 2 * N + 1]) {
    for (lane, cell) in row.windows(size + 1).step_by(size).enumerate() {
        for (column, &h) in out.iter_mut().zip(cell) {
            column[lane] = h;
        }
    }
}

/// The same for row r of `scratch`'s intervals.
#[inline]
pub(super) fn spread_intervals(row: &[Interval], size: usize, r: usize, scratch: &mut Scratch) {
    let (lo, hi) = (&mut scratch.lo[r], &mut scratch.hi[r]);
    let (min, max) = (&mut scratch.min[r], &mut scratch.max[r]);
    for (lane, cell) in row.chunks_exact(size).enumerate() {
        for (u, interval) in cell.iter().enumerate() {
            lo[u][lane] = interval.lo;
            hi[u][lane] = interval.hi;
            min[u][lane] = 16 * interval.min;
            max[u][lane] = 16 * interval.max;
        }
    }
}
