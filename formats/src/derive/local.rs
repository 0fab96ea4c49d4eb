//! A predictor of a tile's deviation codes from the tile's own nodes.

use super::deviation::{Sources, assemble};
use super::field::{Field, Window};
use super::virtual_cells::virtual_centres;

/// Codes of a tile of level k with `side` x `side` nodes (odd, both borders included), as if S_0
/// were the bilinear surface over `nodes` and nothing lay outside. It is a rule of the file
/// format and exact to the bit.
///
/// The tile's corner must be a node whose index on the map is a multiple of 4, so that diagonals
/// alternate from "/" in the first cell. For level 0 the result is the code itself, wherever the
/// cells that it depends on lie in the tile; at a node on the border only what is inside counts.
///
/// In integers, for a cell of 3 x 3 nodes h(x, y), x and y from 0 to 2:
/// - for each quadrant (a, b), a and b in {0, 2}: d = h(a, b), c = h(1, 1), p = h(1, b),
///   q = h(a, 1), twist t = d + c - p - q;
/// - side at (1, b): |16 p - 8 (h(0, b) + h(2, b))| and 4 |t| of both quadrants that touch it; the
///   side at (a, 1) likewise. A side's value is the largest over both cells;
/// - the centre: e = 2 c - (sum of the ends of the cell's diagonal); the largest of 8 |e|, of the
///   |16 p - 8 (..)| of the four sides, and, in the two quadrants on the diagonal, of
///   E + max(0, 4 |t| - 3 |e|, 2 |t| - |e|), with E = max(0, 8 e) if t < 0, else max(0, -8 e);
/// - all are sixteenths of a unit; what exceeds 2^29 counts as 2^29. They are coded as in
///   [`super::code`]: 0 for 0, else with z = 2 x - 1: 1 if z < 4, else 4 e + f + 2 where
///   e = floor(log2 z) - 2 and f = floor(z / 2^e) - 4;
/// - with D the |twist| of each cell of 2 x 2 nodes and V = max(4 D, D of its side neighbours, D / 4
///   of its diagonal neighbours, rounded up), a side's code is raised to those of V in the (two or
///   four) cells that touch it;
/// - last, a centre's code is raised to those of its four sides.
///
/// Returns `side` x `side` codes row by row; (even, even) entries are 0. `None` when `side` is
/// even or `nodes` has another length.
#[must_use]
pub fn local_deviation(nodes: &[i32], side: usize) -> Option<Vec<u8>> {
    if side.is_multiple_of(2) {
        return None;
    }
    let field = Field::from_data(Window::new(0, 0, side, side), nodes.to_vec())?;
    let cells = field.window().cells().coarser_cells();
    let mut out = vec![0; side * side];
    let children = virtual_centres(&field, field.window().cells().expand(1));
    let sources = Sources { nodes: &field, intervals: None, children: Some(&children), span: 0, distances: None };
    assemble(&sources, cells, false, &mut out);
    Some(out)
}
