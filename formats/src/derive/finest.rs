//! [`super::kernel`] where the cells of S_0 and of the deviation's level are the same (n = 1):
//! the finest level, half of all the work, and the predictor's rule.

use multiversion::multiversion;

use super::code::MAX_SIXTEENTHS;
use super::distances::CellRow;
use super::field::Field;
use super::parted::Parted;

/// The three rows of nodes of a row of cells, reused from row to row.
#[derive(Default)]
pub(super) struct Rows {
    south: Parted,
    middle: Parted,
    north: Parted,
}

impl Rows {
    /// Fills entries `first..first + cells` of `out` for the cells (x0.., y) of level k + 1 from
    /// nodes of level k.
    pub(super) fn cell_row(
        &mut self,
        nodes: &Field<i32>,
        (x0, y): (i32, i32),
        (first, cells): (usize, usize),
        out: &mut CellRow,
    ) {
        for (dy, parted) in (0..).zip([&mut self.south, &mut self.middle, &mut self.north]) {
            parted.take(nodes.row(2 * y + dy, 2 * x0, 2 * cells + 1));
        }
        let [centre, south, north, west, east] =
            [&mut out.centre, &mut out.south, &mut out.north, &mut out.west, &mut out.east]
                .map(|v| &mut v[first..first + cells]);
        distances(self, (x0 ^ y) & 1, centre, [south, north, west, east]);
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn distances(rows: &Rows, parity: i32, centre: &mut [i32], sides: [&mut [i32]; 4]) {
    let n = centre.len();
    let [south, north, west, east] = sides.map(|s| &mut s[..n]);
    // The cell's corners, named by their directions, and what lies between them.
    let (h_sw, h_se, h_s) = (&rows.south.even[..n], &rows.south.even[1..=n], &rows.south.odd[..n]);
    let (h_nw, h_ne, h_n) = (&rows.north.even[..n], &rows.north.even[1..=n], &rows.north.odd[..n]);
    let (h_w, h_e, h_c) = (&rows.middle.even[..n], &rows.middle.even[1..=n], &rows.middle.odd[..n]);
    for i in 0..n {
        let residual = |v: i32, a: i32, b: i32| (16 * v - 8 * (a + b)).abs();
        let c = h_c[i];
        let (sw, se, nw, ne) = (
            h_sw[i] + c - h_s[i] - h_w[i],
            h_se[i] + c - h_s[i] - h_e[i],
            h_nw[i] + c - h_n[i] - h_w[i],
            h_ne[i] + c - h_n[i] - h_e[i],
        );
        let (r_s, r_n) = (residual(h_s[i], h_sw[i], h_se[i]), residual(h_n[i], h_nw[i], h_ne[i]));
        let (r_w, r_e) = (residual(h_w[i], h_sw[i], h_nw[i]), residual(h_e[i], h_se[i], h_ne[i]));
        south[i] = r_s.max(4 * sw.abs()).max(4 * se.abs());
        north[i] = r_n.max(4 * nw.abs()).max(4 * ne.abs());
        west[i] = r_w.max(4 * sw.abs()).max(4 * nw.abs());
        east[i] = r_e.max(4 * se.abs()).max(4 * ne.abs());
        let rising = parity ^ (i as i32 & 1) == 0;
        let (t0, t1) = if rising { (sw, ne) } else { (se, nw) };
        let ends = if rising { h_sw[i] + h_ne[i] } else { h_se[i] + h_nw[i] };
        let e = 2 * c - ends;
        let bulge = |t: i32| {
            let end = if t < 0 { (8 * e).max(0) } else { (-8 * e).max(0) };
            end + (4 * t.abs() - 3 * e.abs()).max(2 * t.abs() - e.abs()).max(0)
        };
        let all = r_s.max(r_n).max(r_w).max(r_e).max(8 * e.abs());
        centre[i] = all.max(bulge(t0)).max(bulge(t1)).min(MAX_SIXTEENTHS);
    }
}

#[cfg(test)]
mod tests {
    use super::super::kernel::general_row;
    use super::super::lanes::Scratch;
    use super::super::oracle::noise;
    use super::*;
    use crate::derive::Window;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_the_general_kernel(seed: u64, bits in 1u32..25, x0 in -9i32..9, y in -9i32..9, cells in 1usize..40) {
            let window = Window::new(2 * x0, 2 * y, 2 * cells + 1, 3);
            let half = 1i64 << (bits - 1);
            let nodes = Field::from_fn(window, |x, y| ((noise(x, y, seed) >> (64 - bits)) as i64 - half) as i32);
            let (mut fast, mut general) = (CellRow::new(cells), CellRow::new(cells));
            Rows::default().cell_row(&nodes, (x0, y), (0, cells), &mut fast);
            general_row(&nodes, None, 0, (x0, y), (0, cells), &mut Scratch::new(), &mut general);
            prop_assert_eq!(&fast.centre, &general.centre);
            prop_assert_eq!(&fast.south, &general.south);
            prop_assert_eq!(&fast.north, &general.north);
            prop_assert_eq!(&fast.west, &general.west);
            prop_assert_eq!(&fast.east, &general.east);
        }
    }
}
