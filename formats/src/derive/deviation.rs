//! Deviations for longest-edge bisection on the 4-8 mesh.
//!
//! Every node new at level k (its indices are not both even) halves the hypotenuse of two
//! triangles. (odd, odd) is the centre of a level-(k+1) cell, and the hypotenuse is that cell's
//! diagonal, from south-west to north-east where the cell's indices have an even sum, else from
//! south-east to north-west. Any other is the midpoint of a cell's side, and the apexes are the
//! centres of the two cells that share it. The deviation is the largest |S_0 - T| over the two
//! triangles, heights along the normal and T planar in (column, row, height), and it is saturated:
//! not below those of the (up to four) nodes that halve the triangles' children.

use super::code::encode_sixteenths;
use super::field::{Field, Window};
use super::interval::Interval;
use super::kernel::{CellRow, SPAN, Scratch, cell_row};

/// The level whose nodes stand for S_0 in deviations of level `k`, where level `base` is the
/// finest at hand.
#[must_use]
pub fn sample_level(k: u32, base: u32) -> u32 {
    k.saturating_sub(SPAN).max(base)
}

/// What the deviations of a level k are made from.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// Nodes of level g = k - `span`.
    pub nodes: &'a Field<i32>,
    /// I_g for the cells of level g; `None` where g = 0.
    pub intervals: Option<&'a Field<Interval>>,
    /// Codes of level k - 1 at its (odd, odd) nodes, one for each cell of level k; `None` for
    /// level 0.
    pub children: Option<&'a Field<u8>>,
    /// k - g, 0 to 3.
    pub span: u32,
}

/// Saturated codes of level k at the nodes of `cells` (cells of level k + 1): entry (i, j) of
/// `out` is node (2 x0 + i, 2 y0 + j) of level k, [`deviation_nodes`] in all. (even, even) nodes
/// are new at a coarser level and get 0. Needs sources over `cells.expand(1)`, and children over
/// the level-k cells that touch a node of `cells`. The codes bound the true ones from above.
///
/// # Panics
/// When `out` has not the length of [`deviation_nodes`] or a source does not reach far enough.
pub fn deviations_into(sources: &Sources<'_>, cells: Window, out: &mut [u8]) {
    let ring = cells.expand(1);
    let nodes = Window::new(
        ring.x0 << (sources.span + 1),
        ring.y0 << (sources.span + 1),
        ring.nx << (sources.span + 1),
        ring.ny << (sources.span + 1),
    );
    assert!(sources.span <= SPAN, "nodes at most {SPAN} levels below");
    assert!(sources.nodes.window().contains(&nodes.nodes()), "the triangles reach the nodes {nodes:?}");
    assert!(sources.intervals.is_none_or(|f| f.window().contains(&nodes)), "the triangles reach the cells {nodes:?}");
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
    // Columns of the rows below: one more cell on either side; without a ring these stay 0.
    let reach = if ring { cells.expand(1) } else { Window { x0: cells.x0, nx: cells.nx, ..cells.expand(1) } };
    let mut scratch = Scratch::new();
    let (mut south, mut north) = (CellRow::new(reach.nx), CellRow::new(reach.nx));
    let mut fill = |y: i32, row: &mut CellRow| {
        if ring || (cells.y0..cells.y1()).contains(&y) {
            cell_row(sources.nodes, sources.intervals, sources.span, (reach.x0, y), &mut scratch, row);
        } else {
            row.north.fill(0);
            row.south.fill(0);
        }
    };
    let skip = usize::from(ring);
    fill(reach.y0, &mut south);
    // out's rows: 2 ny + 1, so pairs from the south and one row left over, the northern border.
    for (y, out) in (cells.y0..).zip(out.chunks_mut(2 * nodes.nx)) {
        fill(y, &mut north);
        let (even, odd) = out.split_at_mut(nodes.nx);
        let inner = skip..skip + cells.nx;
        let pairs = south.north[inner.clone()].iter().zip(&north.south[inner.clone()]);
        for (out, (&a, &b)) in even.chunks_mut(2).zip(pairs) {
            out[0] = 0;
            out[1] = encode_sixteenths(a.max(b));
        }
        even[nodes.nx - 1] = 0;
        if !odd.is_empty() {
            odd_row(&north, skip, odd);
        }
        std::mem::swap(&mut south, &mut north);
    }
    saturate(sources.children, nodes, out);
}

/// Codes of an odd row of nodes: side midpoints and centres by turns.
fn odd_row(row: &CellRow, skip: usize, out: &mut [u8]) {
    let cells = out.len() / 2;
    for (i, out) in out.chunks_mut(2).enumerate() {
        let west = (i + skip).checked_sub(1).map_or(0, |i| row.east[i]);
        let east = if skip == 1 || i < cells { row.west[i + skip] } else { 0 };
        out[0] = encode_sixteenths(west.max(east));
        if let Some(centre) = out.get_mut(1) {
            *centre = encode_sixteenths(row.centre[i + skip]);
        }
    }
}

/// Raises sides to their children, the centres of level k - 1, and centres to their sides.
fn saturate(children: Option<&Field<u8>>, nodes: Window, out: &mut [u8]) {
    let nx = nodes.nx;
    if let Some(children) = children {
        for (y, out) in (nodes.y0..).zip(out.chunks_exact_mut(nx)) {
            let below = children.row(y - 1, nodes.x0 - 1, nx + 1);
            let above = children.row(y, nodes.x0 - 1, nx + 1);
            let pairs = below.windows(2).zip(above.windows(2));
            // The window starts at an even node: sides are odd in one index only.
            for (code, (b, a)) in out.iter_mut().zip(pairs).skip(usize::from(y & 1 == 0)).step_by(2) {
                *code = (*code).max(b[0]).max(b[1]).max(a[0]).max(a[1]);
            }
        }
    }
    for y in (1..nodes.ny).step_by(2) {
        let (below, rest) = out.split_at_mut(y * nx);
        let (row, above) = rest.split_at_mut(nx);
        let below = &below[(y - 1) * nx..];
        for x in (1..nx).step_by(2) {
            row[x] = row[x].max(row[x - 1]).max(row[x + 1]).max(below[x]).max(above[x]);
        }
    }
}
