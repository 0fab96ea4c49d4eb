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
use super::distances::CellRow;
use super::field::Field;
use super::interval::Interval;
use super::lanes::{LANES, Lanes, N, Scratch, spread, spread_intervals};

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
            for r in 0..size {
                spread_intervals(intervals.row(gy + r as i32, gx, count * size), size, r, scratch);
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
    let mut maxima = [[0; LANES]; 5];
    for (east, north) in [(false, false), (true, false), (false, true), (true, true)] {
        let quadrant = Quadrant::new(&scratch.nodes, n, parity, east, north);
        let mut max = Maxima { v1: [0; LANES], v2: [0; LANES], centre: [0; LANES] };
        residuals(scratch, n, &quadrant);
        if has_intervals {
            with_intervals(scratch, n, &quadrant, &mut max);
            twists::<true>(scratch, n, &quadrant, &mut max);
        } else {
            on_nodes(scratch, n, &mut max);
            twists::<false>(scratch, n, &quadrant, &mut max);
        }
        let (side1, side2) = (1 + usize::from(north), 3 + usize::from(east));
        for (out, max) in [(0, &max.centre), (side1, &max.v1), (side2, &max.v2)] {
            for (out, max) in maxima[out].iter_mut().zip(max) {
                *out = (*out).max(*max);
            }
        }
    }
    maxima.map(|values| values.map(|v| v.min(MAX_SIXTEENTHS)))
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
        for (start, step) in start.iter_mut().zip(&q.step_w) {
            *start += step;
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

/// Node heights at the corners of cell (u, w) of level g: (u, w), (u + 1, w), (u, w + 1) and
/// (u + 1, w + 1).
#[inline(always)]
fn corners<'a>(
    nodes: &'a [[Lanes; 2 * N + 1]; 2 * N + 1],
    n: usize,
    q: &Quadrant,
    u: usize,
    w: usize,
) -> [&'a Lanes; 4] {
    let (x, x1) = (q.column(n, u), q.column(n, u + 1));
    let (y, y1) = (q.row(n, w), q.row(n, w + 1));
    [&nodes[y][x], &nodes[y][x1], &nodes[y1][x], &nodes[y1][x1]]
}

/// The same corners of an array over one quadrant.
#[inline(always)]
fn four(f: &[[Lanes; N + 1]; N + 1], u: usize, w: usize) -> [&Lanes; 4] {
    [&f[w][u], &f[w][u + 1], &f[w + 1][u], &f[w + 1][u + 1]]
}

/// Bounds of 16 (S_0 - T) over a cell that take nothing from S_g: the extremes of S_0 against those
/// of T, which lie at corners. Tighter than intervals where the ground is rough and T is flat.
#[inline(always)]
fn reach(h: [&Lanes; 4], r: [&Lanes; 4], l: usize, min: i32, max: i32) -> (i32, i32) {
    let t = [0, 1, 2, 3].map(|i| 16 * h[i][l] - r[i][l]);
    let low = t[0].min(t[1]).min(t[2]).min(t[3]);
    let high = t[0].max(t[1]).max(t[2]).max(t[3]);
    (min - high, max - low)
}

/// The largest residuals where S_0 - S_g is known by intervals: over each cell of level g, the
/// corners that lie in a triangle, and the interval on top, but no more than [`reach`] allows.
#[inline(always)]
fn with_intervals(scratch: &Scratch, n: usize, q: &Quadrant, max: &mut Maxima) {
    for w in 0..n {
        let y = q.row(n, w).min(q.row(n, w + 1));
        for u in 0..n {
            let x = q.column(n, u).min(q.column(n, u + 1));
            let (lo, hi) = (&scratch.lo[y][x], &scratch.hi[y][x]);
            let (min, max_h) = (&scratch.min[y][x], &scratch.max[y][x]);
            let h = corners(&scratch.nodes, n, q, u, w);
            let (on1, on2) = (-i32::from(u >= w), -i32::from(u <= w));
            let whole = i32::from(u == w) - 1;
            let (s, c) = (four(&scratch.side, u, w), four(&scratch.centre, u, w));
            for l in 0..LANES {
                let (diag_min, diag_max) = (s[0][l].min(s[3][l]), s[0][l].max(s[3][l]));
                // On the diagonal a half lacks the other half's corner; elsewhere it has all four.
                let (a, b) = (s[1][l], s[2][l]);
                let (a2, b1) = ((a & whole) | (s[0][l] & !whole), (b & whole) | (s[0][l] & !whole));
                let (floor, ceiling) = reach(h, s, l, min[l], max_h[l]);
                let d1 =
                    (diag_max.max(a).max(b1) + hi[l]).min(ceiling).max(-(diag_min.min(a).min(b1) + lo[l]).max(floor));
                let d2 =
                    (diag_max.max(a2).max(b) + hi[l]).min(ceiling).max(-(diag_min.min(a2).min(b) + lo[l]).max(floor));
                max.v1[l] = max.v1[l].max(d1 & on1);
                max.v2[l] = max.v2[l].max(d2 & on2);
                let high = c[0][l].max(c[1][l]).max(c[2][l]).max(c[3][l]);
                let low = c[0][l].min(c[1][l]).min(c[2][l]).min(c[3][l]);
                let (floor, ceiling) = reach(h, c, l, min[l], max_h[l]);
                let d = (high + hi[l]).min(ceiling).max(-(low + lo[l]).max(floor));
                max.centre[l] = max.centre[l].max(d);
            }
        }
    }
}

/// What bilinear cells of level g do on a triangle's slanted edge, between their nodes.
#[inline(always)]
fn twists<const INTERVALS: bool>(scratch: &Scratch, n: usize, q: &Quadrant, max: &mut Maxima) {
    for u in 0..n {
        let (x, y) = (q.column(n, u).min(q.column(n, u + 1)), q.row(n, u).min(q.row(n, u + 1)));
        let (lo, hi) = (&scratch.lo[y][x], &scratch.hi[y][x]);
        let (min, max_h) = (&scratch.min[y][x], &scratch.max[y][x]);
        let h = corners(&scratch.nodes, n, q, u, u);
        let (s, c) = (four(&scratch.side, u, u), four(&scratch.centre, u, u));
        for l in 0..LANES {
            let twist = h[0][l] + h[3][l] - h[1][l] - h[2][l];
            let mut side = bulge(s[0][l], s[3][l], twist);
            let mut centre = bulge(c[0][l], c[3][l], twist);
            if INTERVALS {
                let outer = if twist < 0 { hi[l] } else { -lo[l] };
                let limit = |r: [&Lanes; 4]| {
                    let (floor, ceiling) = reach(h, r, l, min[l], max_h[l]);
                    if twist < 0 { ceiling } else { -floor }
                };
                side = (side + outer).min(limit(s));
                centre = (centre + outer).min(limit(c));
            }
            let centre = centre & q.cut[l];
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
