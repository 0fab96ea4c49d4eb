//! The largest distance between S_0 and the triangles of the 4-8 mesh, for a row of cells.
//!
//! A cell of level k + 1 (its corners are even nodes of level k) holds one new centre and a half
//! of each of its four sides' triangles. Its four quadrants, cells of level k, are alike up to
//! reflection: corner D1 is even, D2 is the centre, V1 and V2 are the midpoints of a horizontal
//! and a vertical side, and the quadrant's own diagonal D1-D2 parts the triangle on V1's side
//! (u >= w) from the one on V2's. With u and w counted from D1 in cells of level g, n = 2^(k-g)
//! of them, both meshes that matter are
//!
//!   T(u, w) = D1 + (V1 - D1) u / n + (V2 - D1) w / n + (D1 + D2 - V1 - V2) min(u, w) / n
//!
//! where V1 and V2 stand for the means of their sides' ends, and D2 is the centre's own height
//! for the sides' triangles, or the mean of the cell's diagonal for the centre's. In sixteenths
//! of a unit all of this is exact in integers for n <= 8.

use multiversion::multiversion;

use super::code::MAX_SIXTEENTHS;
use super::field::Field;
use super::interval::Interval;

/// Cells worked on at once: the arrays' innermost index, so that a compiler vectorises over it.
const LANES: usize = 16;
/// Levels between the nodes that are looked at and the level of a deviation, at most.
pub(super) const SPAN: u32 = 3;
/// n at most.
const N: usize = 1 << SPAN;

type Lanes = [i32; LANES];

/// The largest distances in one cell of level k + 1, in sixteenths of a unit, not saturated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellDistances {
    /// Over the two triangles that share the cell's diagonal.
    pub centre: i32,
    /// Over the triangles on the southern, northern, western, eastern side, apex at the centre.
    pub sides: [i32; 4],
}

/// [`CellDistances`] of a row of cells, an array for each.
pub(super) struct CellRow {
    /// Over the two triangles that share the cell's diagonal.
    pub centre: Vec<i32>,
    /// Over the triangle on the cell's southern side, apex at its centre.
    pub south: Vec<i32>,
    /// The same on the northern side.
    pub north: Vec<i32>,
    /// The same on the western side.
    pub west: Vec<i32>,
    /// The same on the eastern side.
    pub east: Vec<i32>,
}

impl CellRow {
    pub(super) fn new(cells: usize) -> Self {
        let zeros = vec![0; cells];
        Self { centre: zeros.clone(), south: zeros.clone(), north: zeros.clone(), west: zeros.clone(), east: zeros }
    }

    /// The cell at index i.
    pub(super) fn get(&self, i: usize) -> CellDistances {
        CellDistances { centre: self.centre[i], sides: [self.south[i], self.north[i], self.west[i], self.east[i]] }
    }

    /// Writes cells from index `first` on.
    pub(super) fn set(&mut self, first: usize, cells: &[CellDistances]) {
        for (i, cell) in (first..).zip(cells) {
            self.centre[i] = cell.centre;
            [self.south[i], self.north[i], self.west[i], self.east[i]] = cell.sides;
        }
    }
}

/// The arrays of one run of [`LANES`] cells, reused from run to run.
pub(super) struct Scratch {
    /// Node heights, [row][column][cell].
    nodes: Box<[[Lanes; 2 * N + 1]; 2 * N + 1]>,
    /// Lower bounds of S_0 - S_g, [row][column][cell].
    lo: Box<[[Lanes; 2 * N]; 2 * N]>,
    /// Upper bounds.
    hi: Box<[[Lanes; 2 * N]; 2 * N]>,
    /// One quadrant's 16 (S_g - T) at its nodes, for the sides' mesh.
    side: Box<[[Lanes; N + 1]; N + 1]>,
    /// The same for the centre's mesh.
    centre: Box<[[Lanes; N + 1]; N + 1]>,
}

impl Scratch {
    pub(super) fn new() -> Self {
        let zero = [0; LANES];
        Self {
            nodes: Box::new([[zero; 2 * N + 1]; 2 * N + 1]),
            lo: Box::new([[zero; 2 * N]; 2 * N]),
            hi: Box::new([[zero; 2 * N]; 2 * N]),
            side: Box::new([[zero; N + 1]; N + 1]),
            centre: Box::new([[zero; N + 1]; N + 1]),
        }
    }
}

/// Fills entries `first..first + cells` of `out` for the cells (x0.., y) of level k + 1 from nodes
/// of level g = k - `span` and, for g > 0, the intervals of its cells.
pub(super) fn general_row(
    nodes: &Field<i32>,
    intervals: Option<&Field<Interval>>,
    span: u32,
    (x0, y): (i32, i32),
    (first, cells): (usize, usize),
    scratch: &mut Scratch,
    out: &mut CellRow,
) {
    let size = 2usize << span;
    for done in (0..cells).step_by(LANES) {
        let count = LANES.min(cells - done);
        let x = x0 + done as i32;
        let (gx, gy) = (x << (span + 1), y << (span + 1));
        for (r, row) in (gy..).zip(&mut scratch.nodes[..=size]) {
            spread(nodes.row(r, gx, count * size + 1), size, row);
        }
        if let Some(intervals) = intervals {
            for ((r, lo), hi) in (gy..).zip(&mut scratch.lo[..size]).zip(&mut scratch.hi[..size]) {
                spread_intervals(intervals.row(r, gx, count * size), size, lo, hi);
            }
        }
        let run = run(scratch, size / 2, (x ^ y) & 1, intervals.is_some());
        let range = first + done..first + done + count;
        for (target, values) in
            [&mut out.centre, &mut out.south, &mut out.north, &mut out.west, &mut out.east].into_iter().zip(&run)
        {
            target[range.clone()].copy_from_slice(&values[..count]);
        }
    }
}

/// Deals a row of `size` columns a cell out to the cells' lanes; lanes without a cell keep what
/// they had, and nobody reads their results.
#[inline]
fn spread(row: &[i32], size: usize, out: &mut [Lanes; 2 * N + 1]) {
    for (lane, cell) in row.windows(size + 1).step_by(size).enumerate() {
        for (column, &h) in out.iter_mut().zip(cell) {
            column[lane] = h;
        }
    }
}

#[inline]
fn spread_intervals(row: &[Interval], size: usize, lo: &mut [Lanes; 2 * N], hi: &mut [Lanes; 2 * N]) {
    for (lane, cell) in row.chunks_exact(size).enumerate() {
        for ((lo, hi), interval) in lo.iter_mut().zip(hi.iter_mut()).zip(cell) {
            lo[lane] = interval.lo;
            hi[lane] = interval.hi;
        }
    }
}

/// One quadrant of each cell: where it lies, and what it takes to write T down.
struct Quadrant {
    /// True when D1 is the eastern, the northern corner.
    east: bool,
    north: bool,
    /// 16 D1, and the steps of 16 T in u, in w, in min(u, w).
    d1: Lanes,
    step_u: Lanes,
    step_w: Lanes,
    step_min: Lanes,
    /// The step in min(u, w) by which the centre's mesh lies below the sides'.
    step_centre: Lanes,
    /// All ones where the cell's diagonal passes through the quadrant, else zero.
    cut: Lanes,
}

impl Quadrant {
    #[inline(always)]
    fn new(nodes: &[[Lanes; 2 * N + 1]; 2 * N + 1], n: usize, parity: i32, east: bool, north: bool) -> Self {
        let end = |far: bool| if far { 2 * n } else { 0 };
        let (x, y) = (end(east), end(north));
        let (d1, across, along) = (&nodes[y][x], &nodes[y][2 * n - x], &nodes[2 * n - y][x]);
        let opposite = &nodes[2 * n - y][2 * n - x];
        let middle = &nodes[n][n];
        let unit = 8 >> n.trailing_zeros();
        let mut q = Self {
            east,
            north,
            d1: [0; LANES],
            step_u: [0; LANES],
            step_w: [0; LANES],
            step_min: [0; LANES],
            step_centre: [0; LANES],
            cut: [0; LANES],
        };
        for l in 0..LANES {
            // The cell's diagonal is "/" where its indices' sum is even.
            let cut = -((parity ^ l as i32 ^ east as i32 ^ north as i32 ^ 1) & 1);
            let through = d1[l] + opposite[l];
            let aside = across[l] + along[l];
            let diagonal = (through & cut) | (aside & !cut);
            q.d1[l] = 16 * d1[l];
            q.step_u[l] = unit * (across[l] - d1[l]);
            q.step_w[l] = unit * (along[l] - d1[l]);
            q.step_min[l] = unit * (2 * middle[l] - aside);
            q.step_centre[l] = unit * (2 * middle[l] - diagonal);
            q.cut[l] = cut;
        }
        q
    }

    /// Index of column or row u of the quadrant within the cell.
    #[inline(always)]
    fn column(&self, n: usize, u: usize) -> usize {
        if self.east { 2 * n - u } else { u }
    }

    #[inline(always)]
    fn row(&self, n: usize, w: usize) -> usize {
        if self.north { 2 * n - w } else { w }
    }
}

/// Largest distances on V1's triangle, on V2's, and on the centre's.
struct Maxima {
    v1: Lanes,
    v2: Lanes,
    centre: Lanes,
}

/// Centre, south, north, west, east of each lane's cell.
#[multiversion(targets("x86_64+avx2"))]
fn run(scratch: &mut Scratch, n: usize, parity: i32, has_intervals: bool) -> [Lanes; 5] {
    let mut out = [[0; LANES]; 5];
    for (east, north) in [(false, false), (true, false), (false, true), (true, true)] {
        let quadrant = Quadrant::new(&scratch.nodes, n, parity, east, north);
        let mut max = Maxima { v1: [0; LANES], v2: [0; LANES], centre: [0; LANES] };
        residuals(scratch, n, &quadrant);
        if has_intervals {
            with_intervals(scratch, n, &quadrant, &mut max);
        } else {
            on_nodes(scratch, n, &mut max);
        }
        twists(scratch, n, &quadrant, has_intervals, &mut max);
        let (side1, side2) = (1 + usize::from(north), 3 + usize::from(east));
        for l in 0..LANES {
            out[0][l] = out[0][l].max(max.centre[l]);
            out[side1][l] = out[side1][l].max(max.v1[l]);
            out[side2][l] = out[side2][l].max(max.v2[l]);
        }
    }
    for values in &mut out {
        for v in values {
            *v = (*v).min(MAX_SIXTEENTHS);
        }
    }
    out
}

/// 16 (S_g - T) at the quadrant's nodes, for both meshes.
#[inline(always)]
fn residuals(scratch: &mut Scratch, n: usize, q: &Quadrant) {
    let mut start = q.d1;
    for w in 0..=n {
        let row = &scratch.nodes[q.row(n, w)];
        let mut t = start;
        let mut lift = [0; LANES];
        for u in 0..=n {
            let h = &row[q.column(n, u)];
            let (side, centre) = (&mut scratch.side[w][u], &mut scratch.centre[w][u]);
            let rising = -i32::from(u < w);
            for l in 0..LANES {
                let r = 16 * h[l] - t[l];
                side[l] = r;
                centre[l] = r + lift[l];
                t[l] += q.step_u[l] + (q.step_min[l] & rising);
                lift[l] += q.step_centre[l] & rising;
            }
        }
        for l in 0..LANES {
            start[l] += q.step_w[l];
        }
    }
}

/// The largest residuals where S_0 = S_g: at the nodes.
#[inline(always)]
fn on_nodes(scratch: &Scratch, n: usize, max: &mut Maxima) {
    for w in 0..=n {
        for u in 0..=n {
            let (side, centre) = (&scratch.side[w][u], &scratch.centre[w][u]);
            let (on1, on2) = (-i32::from(u >= w), -i32::from(u <= w));
            for l in 0..LANES {
                let r = side[l].abs();
                max.v1[l] = max.v1[l].max(r & on1);
                max.v2[l] = max.v2[l].max(r & on2);
                max.centre[l] = max.centre[l].max(centre[l].abs());
            }
        }
    }
}

/// The largest residuals where S_0 - S_g is known by intervals: over each cell of level g, the
/// corners that lie in a triangle, and the interval on top.
#[inline(always)]
fn with_intervals(scratch: &Scratch, n: usize, q: &Quadrant, max: &mut Maxima) {
    for w in 0..n {
        let y = q.row(n, w).min(q.row(n, w + 1));
        for u in 0..n {
            let x = q.column(n, u).min(q.column(n, u + 1));
            let (lo, hi) = (&scratch.lo[y][x], &scratch.hi[y][x]);
            let (on1, on2) = (-i32::from(u >= w), -i32::from(u <= w));
            let whole = i32::from(u == w) - 1;
            let s = [&scratch.side[w][u], &scratch.side[w][u + 1], &scratch.side[w + 1][u], &scratch.side[w + 1][u + 1]];
            let c = [
                &scratch.centre[w][u],
                &scratch.centre[w][u + 1],
                &scratch.centre[w + 1][u],
                &scratch.centre[w + 1][u + 1],
            ];
            for l in 0..LANES {
                let (diag_min, diag_max) = (s[0][l].min(s[3][l]), s[0][l].max(s[3][l]));
                // On the diagonal a half lacks the other half's corner; elsewhere it has all four.
                let (a, b) = (s[1][l], s[2][l]);
                let (a2, b1) = ((a & whole) | (s[0][l] & !whole), (b & whole) | (s[0][l] & !whole));
                let d1 = (diag_max.max(a).max(b1) + hi[l]).max(-(diag_min.min(a).min(b1) + lo[l]));
                let d2 = (diag_max.max(a2).max(b) + hi[l]).max(-(diag_min.min(a2).min(b) + lo[l]));
                max.v1[l] = max.v1[l].max(d1 & on1);
                max.v2[l] = max.v2[l].max(d2 & on2);
                let high = c[0][l].max(c[1][l]).max(c[2][l]).max(c[3][l]);
                let low = c[0][l].min(c[1][l]).min(c[2][l]).min(c[3][l]);
                max.centre[l] = max.centre[l].max((high + hi[l]).max(-(low + lo[l])));
            }
        }
    }
}

/// What bilinear cells of level g do on a triangle's slanted edge, between their nodes.
#[inline(always)]
fn twists(scratch: &Scratch, n: usize, q: &Quadrant, has_intervals: bool, max: &mut Maxima) {
    for u in 0..n {
        let (x, x1) = (q.column(n, u), q.column(n, u + 1));
        let (y, y1) = (q.row(n, u), q.row(n, u + 1));
        let h = &scratch.nodes;
        let (lo, hi) = (&scratch.lo[y.min(y1)][x.min(x1)], &scratch.hi[y.min(y1)][x.min(x1)]);
        let with = -i32::from(has_intervals);
        let (s0, s1) = (&scratch.side[u][u], &scratch.side[u + 1][u + 1]);
        let (c0, c1) = (&scratch.centre[u][u], &scratch.centre[u + 1][u + 1]);
        for l in 0..LANES {
            let twist = h[y][x][l] + h[y1][x1][l] - h[y][x1][l] - h[y1][x][l];
            let outer = (if twist < 0 { hi[l] } else { -lo[l] }) & with;
            let side = bulge(s0[l], s1[l], twist) + outer;
            let centre = (bulge(c0[l], c1[l], twist) + outer) & q.cut[l];
            max.v1[l] = max.v1[l].max(side);
            max.v2[l] = max.v2[l].max(side);
            max.centre[l] = max.centre[l].max(centre);
        }
    }
}

/// An upper bound of |S - T| on a cell's diagonal, to the side to which S bulges, in sixteenths.
///
/// With r0, r1 the residuals at its ends (sixteenths) and t the twist h00 + h11 - h01 - h10
/// (units), the residual is r0 + (r1 - r0) x - 16 t x (1 - x). Past the end on that side it rises
/// by 16 |t| (1 - d)^2 / 4, d = |r1 - r0| / (16 |t|), if d < 1. The chords over d in [0, 1/2] and
/// [1/2, 1] bound the square from above: 4 |t| - 3/8 |r1 - r0| and 2 |t| - 1/8 |r1 - r0|.
#[inline(always)]
fn bulge(r0: i32, r1: i32, twist: i32) -> i32 {
    let sign = twist >> 31; // 0 or -1
    let size = (twist ^ sign) - sign;
    let end = if twist < 0 { r0.max(r1) } else { -r0.min(r1) };
    let slope = (r1 - r0).abs();
    let three_eighths = ((slope as u32 * 3) >> 3) as i32;
    end + (4 * size - three_eighths).max(2 * size - (slope >> 3)).max(0)
}
