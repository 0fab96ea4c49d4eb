//! What the virtual nodes below level 0 need of the centres of level-0 cells.
//!
//! Below level 0 the bisection goes on within the bilinear cells. In a cell of twist
//! d = |h00 - h10 - h01 + h11| its centre lies d / 4 off the diagonal that it halves, and the
//! triangles on a side of the cell, apex at the centre, bulge by d / 16; a cell half as wide has a
//! quarter of the twist. The triangles below a centre reach less than one cell beyond its own, so
//! its saturated deviation is
//!
//!   V = max(D / 4, D / 16 of the four side neighbours, D / 64 of the four diagonal ones).

use multiversion::multiversion;

use super::code::encode_sixteenths;
use super::field::{Field, Window};

/// Codes of V, one for each of `cells` (level 0): the children of level 0's side midpoints.
/// Cells without all four corners in `nodes` count as missing.
#[must_use]
pub fn virtual_centres(nodes: &Field<i32>, cells: Window) -> Field<u8> {
    let mut out = Field::new(cells);
    if cells.is_empty() {
        return out;
    }
    let ring = cells.expand(1);
    let known = nodes.window().cells();
    let (x0, x1) = (ring.x0.max(known.x0), ring.x1().min(known.x1()));
    let n = (x1 - x0).max(0) as usize;
    let fill = |y: i32, row: &mut Vec<i32>| {
        row.clear();
        row.resize(ring.nx, 0);
        if n > 0 && (known.y0..known.y1()).contains(&y) {
            let first = (x0 - ring.x0) as usize;
            twists(nodes.row(y, x0, n + 1), nodes.row(y + 1, x0, n + 1), &mut row[first..first + n]);
        }
    };
    let mut rows: [Vec<i32>; 3] = Default::default();
    fill(cells.y0 - 1, &mut rows[1]);
    fill(cells.y0, &mut rows[2]);
    for (y, out) in (cells.y0..).zip(out.data_mut().chunks_exact_mut(cells.nx)) {
        rows.rotate_left(1);
        fill(y + 1, &mut rows[2]);
        saturate(&rows, out);
    }
    out
}

/// Raises the codes at the centres of cells of a level below which there is nothing but bilinear
/// interpolation, as `interpolated` tells: to V of the level's own nodes, and to the codes of
/// neighbours below which there is more. The interpolated nodes are whole units; over all levels
/// below that moves any of them by at most `rounding` sixteenths, which a triangle's corners and
/// the surface may do in opposite directions. Cells on the border of `centres` stay as they are.
///
/// # Panics
/// When `nodes` lacks a corner of a cell.
pub fn raise_interpolated(
    centres: &mut Field<u8>,
    nodes: &Field<i32>,
    rounding: i32,
    interpolated: impl Fn(i32, i32) -> bool,
) {
    let window = centres.window();
    assert!(nodes.window().contains(&window.nodes()), "the cells' corners are {:?}", window.nodes());
    let known = centres.clone();
    let interpolated = Field::from_fn(window, interpolated);
    for y in window.y0 + 1..window.y1() - 1 {
        for x in (window.x0 + 1..window.x1() - 1).filter(|&x| interpolated.at(x, y)) {
            let (mut sixteenths, mut code, mut flat) = (0, 0, true);
            for (dx, dy) in (-1..=1).flat_map(|dy: i32| (-1..=1).map(move |dx: i32| (dx, dy))) {
                let (x, y) = (x + dx, y + dy);
                let (south, north) = (nodes.row(y, x, 2), nodes.row(y + 1, x, 2));
                let twist = (south[0] - south[1] - north[0] + north[1]).abs();
                flat &= south[0] == south[1] && south == north;
                sixteenths = sixteenths.max(match dx.abs() + dy.abs() {
                    0 => 4 * twist,
                    1 => twist,
                    _ => (twist + 3) >> 2,
                });
                if !interpolated.at(x, y) {
                    code = code.max(known.at(x, y));
                }
            }
            code = code.max(if flat { 0 } else { encode_sixteenths(sixteenths + 2 * rounding) });
            let at = (y - window.y0) as usize * window.nx + (x - window.x0) as usize;
            centres.data_mut()[at] = code.max(known.at(x, y));
        }
    }
}

/// |h00 - h10 - h01 + h11| of a row of cells.
#[multiversion(targets("x86_64+avx2"))]
fn twists(south: &[i32], north: &[i32], out: &mut [i32]) {
    let n = out.len();
    let [sw, se, nw, ne] = [&south[..n], &south[1..=n], &north[..n], &north[1..=n]];
    for i in 0..n {
        out[i] = (sw[i] - se[i] - nw[i] + ne[i]).abs();
    }
}

/// V of the middle row in sixteenths of a unit (D / 64 rounded up), coded; rows reach one cell
/// further on either side.
#[multiversion(targets("x86_64+avx2"))]
fn saturate(rows: &[Vec<i32>; 3], out: &mut [u8]) {
    let n = out.len();
    let [south, own, north] = rows.each_ref().map(|row| &row[..n + 2]);
    for i in 0..n {
        let side = own[i].max(own[i + 2]).max(south[i + 1]).max(north[i + 1]);
        let diagonal = south[i].max(south[i + 2]).max(north[i]).max(north[i + 2]);
        out[i] = encode_sixteenths((4 * own[i + 1]).max(side).max((diagonal + 3) >> 2));
    }
}
