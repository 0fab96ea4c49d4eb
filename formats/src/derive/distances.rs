//! Largest distances between S_0 and triangles, before they become codes.

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
