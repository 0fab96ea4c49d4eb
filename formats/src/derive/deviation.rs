//! Deviations for longest-edge bisection on the 4-8 mesh.
//!
//! Every node new at level k (its indices are not both even) halves the hypotenuse of two
//! triangles. (odd, odd) is the centre of a level-(k+1) cell, and the hypotenuse is that cell's
//! diagonal, from south-west to north-east where the cell's indices have an even sum, else from
//! south-east to north-west. Any other is the midpoint of a cell's side, and the apexes are the
//! centres of the two cells that share it. The deviation is the largest |S_0 - T| over the two
//! triangles, heights along the normal and T planar in (column, row, height), and it is saturated:
//! not below those of the (up to four) nodes that halve the triangles' children. It so bounds all
//! that can be drawn, for the bisection goes on below level 0 ([`super::virtual_cells`]).

use multiversion::multiversion;

use super::code::encode_sixteenths;
use super::distances::CellRow;
use super::field::{Field, Window};
use super::finest::Rows;
use super::interval::Interval;
use super::kernel::general_row;
use super::lanes::{SPAN, Scratch};

pub use super::distances::CellDistances;

/// What the deviations of a level k are made from.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// Nodes of level g = k - `span`.
    pub nodes: &'a Field<i32>,
    /// I_g for the cells of level g; `None` where g = 0.
    pub intervals: Option<&'a Field<Interval>>,
    /// Codes of level k - 1 at its (odd, odd) nodes, one for each cell of level k; for level 0
    /// those of [`super::virtual_cells`]. `None`: not raised to children.
    pub children: Option<&'a Field<u8>>,
    /// k - g, 0 to 3.
    pub span: u32,
    /// The distances of level k worked out before, for each cell of level k + 1; then `nodes` and
    /// `intervals` are not looked at.
    pub distances: Option<&'a Field<CellDistances>>,
}

/// The distances of level k in each cell of `window`, cells of level k + 1, from what lies in the
/// cells alone: a stage hands them on where the next one has too coarse nodes of its own.
///
/// # Panics
/// When a source does not reach far enough.
#[must_use]
pub fn cell_distances(sources: &Sources<'_>, window: Window) -> Field<CellDistances> {
    sources.check(window);
    let mut out = Field::new(window);
    let mut distances = Distances::new(sources, window, false);
    let mut row = CellRow::new(window.nx + 2);
    for (y, out) in (window.y0..).zip(out.data_mut().chunks_exact_mut(window.nx.max(1))) {
        distances.fill(y, &mut row);
        for (i, out) in (1..).zip(out) {
            *out = row.get(i);
        }
    }
    out
}

impl Sources<'_> {
    /// Panics unless distances can be had for all of `cells`.
    fn check(&self, cells: Window) {
        if let Some(distances) = self.distances {
            assert!(distances.window().contains(&cells), "distances are needed in {cells:?}");
            return;
        }
        let up = self.span + 1;
        let fine = Window::new(cells.x0 << up, cells.y0 << up, cells.nx << up, cells.ny << up);
        assert!(self.span <= SPAN, "nodes at most {SPAN} levels below");
        assert!(self.nodes.window().contains(&fine.nodes()), "the triangles reach the nodes of {fine:?}");
        assert!(self.intervals.is_none_or(|f| f.window().contains(&fine)), "the triangles reach the cells {fine:?}");
    }
}

/// Saturated codes of level k at the nodes of `cells` (cells of level k + 1): entry (i, j) of
/// `out` is node (2 x0 + i, 2 y0 + j) of level k, [`deviation_nodes`] in all. (even, even) nodes
/// are new at a coarser level and get 0. Needs sources over `cells.expand(1)`, and children over
/// the level-k cells that touch a node of `cells`. The codes bound the true ones from above.
///
/// # Panics
/// When `out` has not the length of [`deviation_nodes`] or a source does not reach far enough.
pub fn deviations_into(sources: &Sources<'_>, cells: Window, out: &mut [u8]) {
    sources.check(cells.expand(1));
    let touching = cells.finer_cells().expand(1);
    assert!(sources.children.is_none_or(|f| f.window().contains(&touching)), "the children lie in {touching:?}");
    assemble(sources, cells, true, out);
}

/// [`deviations_into`] a new field over [`deviation_nodes`].
///
/// # Panics
/// As [`deviations_into`].
#[must_use]
pub fn deviations(sources: &Sources<'_>, cells: Window) -> Field<u8> {
    let mut out = Field::new(deviation_nodes(cells));
    deviations_into(sources, cells, out.data_mut());
    out
}

/// The level-k nodes of `cells`, cells of level k + 1.
#[must_use]
pub const fn deviation_nodes(cells: Window) -> Window {
    cells.finer_cells().nodes()
}

/// The codes at (odd, odd) nodes of a plane of level k, one for each cell of level k + 1: the
/// `children` of the next level.
#[must_use]
pub fn centres(codes: &Field<u8>) -> Field<u8> {
    let cells = codes.window().cells().coarser_cells();
    let mut out = Field::new(cells);
    if !cells.is_empty() {
        for (y, out) in (cells.y0..).zip(out.data_mut().chunks_exact_mut(cells.nx)) {
            let row = codes.row(2 * y + 1, 2 * cells.x0 + 1, 2 * cells.nx - 1);
            for (out, &code) in out.iter_mut().zip(row.iter().step_by(2)) {
                *out = code;
            }
        }
    }
    out
}

/// Codes at the nodes of `cells`. Without `ring` no cell outside is looked at, and a side on the
/// border has only its triangle inside.
pub(super) fn assemble(sources: &Sources<'_>, cells: Window, ring: bool, out: &mut [u8]) {
    let nodes = deviation_nodes(cells);
    assert_eq!(out.len(), nodes.len(), "one code for each node");
    if cells.is_empty() {
        out.fill(0);
        return;
    }
    let mut distances = Distances::new(sources, cells, ring);
    // A row has one more cell on either side; without a ring these stay 0.
    let (mut south, mut north) = (CellRow::new(cells.nx + 2), CellRow::new(cells.nx + 2));
    distances.fill(cells.y0 - 1, &mut south);
    // out's rows: 2 ny + 1, so pairs from the south and one row left over, the northern border.
    for (y, out) in (cells.y0..).zip(out.chunks_mut(2 * nodes.nx)) {
        distances.fill(y, &mut north);
        let (even, odd) = out.split_at_mut(nodes.nx);
        even_row(&south.north, &north.south, even);
        if !odd.is_empty() {
            odd_row(&north, odd);
        }
        std::mem::swap(&mut south, &mut north);
    }
    if let Some(children) = sources.children {
        for (y, out) in (nodes.y0..).zip(out.chunks_exact_mut(nodes.nx)) {
            let below = children.row(y - 1, nodes.x0 - 1, nodes.nx + 1);
            let above = children.row(y, nodes.x0 - 1, nodes.nx + 1);
            raise_to_children(below, above, y & 1 == 0, out);
        }
    }
    let mut sides = Vec::new();
    for y in (1..nodes.ny).step_by(2) {
        let (below, rest) = out.split_at_mut(y * nodes.nx);
        let (row, above) = rest.split_at_mut(nodes.nx);
        sides.clear();
        sides.extend_from_slice(row);
        raise_to_sides([&below[(y - 1) * nodes.nx..], &sides, &above[..nodes.nx]], row);
    }
}

/// Rows of distances for one window.
struct Distances<'a> {
    sources: &'a Sources<'a>,
    cells: Window,
    ring: bool,
    finest: Rows,
    scratch: Scratch,
}

impl<'a> Distances<'a> {
    fn new(sources: &'a Sources<'a>, cells: Window, ring: bool) -> Self {
        Self { sources, cells, ring, finest: Rows::default(), scratch: Scratch::new() }
    }

    /// Row y of cells: entry 0 of `out` is the cell west of the window.
    fn fill(&mut self, y: i32, out: &mut CellRow) {
        let Sources { nodes, intervals, span, distances, .. } = *self.sources;
        let Window { x0, nx, .. } = self.cells;
        let (corner, range) = if self.ring { ((x0 - 1, y), (0, nx + 2)) } else { ((x0, y), (1, nx)) };
        if !self.ring && !(self.cells.y0..self.cells.y1()).contains(&y) {
            out.north.fill(0);
            out.south.fill(0);
        } else if let Some(distances) = distances {
            out.set(range.0, distances.row(y, corner.0, range.1));
        } else if span == 0 && intervals.is_none() {
            self.finest.cell_row(nodes, corner, range, out);
        } else {
            general_row(nodes, intervals, span, corner, range, &mut self.scratch, out);
        }
    }
}

/// Codes of an even row of nodes: nothing and side midpoints by turns.
#[multiversion(targets("x86_64+avx2"))]
fn even_row(south: &[i32], north: &[i32], out: &mut [u8]) {
    for ((out, &s), &n) in out.chunks_exact_mut(2).zip(&south[1..]).zip(&north[1..]) {
        (out[0], out[1]) = (0, encode_sixteenths(s.max(n)));
    }
    if let Some(last) = out.last_mut() {
        *last = 0;
    }
}

/// Codes of an odd row of nodes: side midpoints and centres by turns.
#[multiversion(targets("x86_64+avx2"))]
fn odd_row(row: &CellRow, out: &mut [u8]) {
    let sides = row.east.iter().zip(&row.west[1..]).map(|(e, w)| *e.max(w));
    for ((out, side), &centre) in out.chunks_exact_mut(2).zip(sides).zip(&row.centre[1..]) {
        (out[0], out[1]) = (encode_sixteenths(side), encode_sixteenths(centre));
    }
    let n = row.west.len();
    if let Some(last) = out.last_mut() {
        *last = encode_sixteenths(row.east[n - 2].max(row.west[n - 1]));
    }
}

/// Raises a row's side midpoints to their children, the centres of level k - 1 in the four cells
/// of level k about them. Centres in an odd row are raised too: their sides have the same children.
#[multiversion(targets("x86_64+avx2"))]
fn raise_to_children(below: &[u8], above: &[u8], even: bool, out: &mut [u8]) {
    let n = out.len();
    let [b0, b1, a0, a1] = [&below[..n], &below[1..=n], &above[..n], &above[1..=n]];
    for i in 0..n {
        let raised = out[i].max(b0[i]).max(b1[i]).max(a0[i]).max(a1[i]);
        let new = !even || i & 1 == 1;
        out[i] = if new { raised } else { 0 };
    }
}

/// Raises a row's centres to their four sides.
#[multiversion(targets("x86_64+avx2"))]
fn raise_to_sides(rows: [&[u8]; 3], out: &mut [u8]) {
    let [below, sides, above] = rows;
    let pairs = below.chunks_exact(2).zip(above.chunks_exact(2));
    for ((out, (b, a)), s) in out.chunks_exact_mut(2).zip(pairs).zip(sides.windows(3).step_by(2)) {
        out[1] = out[1].max(s[0]).max(s[2]).max(b[1]).max(a[1]);
    }
}
