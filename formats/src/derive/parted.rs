//! Rows of nodes with even and odd columns apart, so that a stride of two becomes one.

use multiversion::multiversion;

/// A row of nodes, parted: corners and side midpoints, or side midpoints and centres.
#[derive(Default)]
pub(super) struct Parted {
    /// Entries 0, 2, ...
    pub even: Vec<i32>,
    /// Entries 1, 3, ...
    pub odd: Vec<i32>,
}

impl Parted {
    /// Takes a row of an odd number of nodes.
    pub(super) fn take(&mut self, row: &[i32]) {
        self.even.resize(row.len().div_ceil(2), 0);
        self.odd.resize(row.len() / 2, 0);
        part(row, &mut self.even, &mut self.odd);
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn part(row: &[i32], even: &mut [i32], odd: &mut [i32]) {
    for ((pair, even), odd) in row.chunks_exact(2).zip(even.iter_mut()).zip(odd) {
        (*even, *odd) = (pair[0], pair[1]);
    }
    if let (Some(last), Some(&h)) = (even.last_mut(), row.last()) {
        *last = h;
    }
}
