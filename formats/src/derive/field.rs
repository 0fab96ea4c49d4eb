//! Rectangles of a level's nodes or cells, addressed by their indices on the whole map.

/// A half-open rectangle of node or cell indices of one level. Indices may be negative or beyond
/// the map: there lies the padding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x0: i32,
    /// First row.
    pub y0: i32,
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
}

impl Window {
    /// The rectangle with `nx` x `ny` entries whose first is (x0, y0).
    #[must_use]
    pub const fn new(x0: i32, y0: i32, nx: usize, ny: usize) -> Self {
        Self { x0, y0, nx, ny }
    }

    /// The rectangle of x0..x1 by y0..y1, empty where an end precedes its start.
    #[must_use]
    pub fn between(x0: i32, x1: i32, y0: i32, y1: i32) -> Self {
        Self { x0, y0, nx: (x1 - x0).max(0) as usize, ny: (y1 - y0).max(0) as usize }
    }

    /// One past the last column.
    #[must_use]
    pub const fn x1(&self) -> i32 {
        self.x0 + self.nx as i32
    }

    /// One past the last row.
    #[must_use]
    pub const fn y1(&self) -> i32 {
        self.y0 + self.ny as i32
    }

    /// Entries.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.nx * self.ny
    }

    /// True without entries.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.nx == 0 || self.ny == 0
    }

    /// Wider by `by` entries on each of the four sides.
    #[must_use]
    pub const fn expand(&self, by: i32) -> Self {
        let more = 2 * by as usize;
        Self { x0: self.x0 - by, y0: self.y0 - by, nx: self.nx + more, ny: self.ny + more }
    }

    /// True when `other` lies inside.
    #[must_use]
    pub const fn contains(&self, other: &Self) -> bool {
        self.x0 <= other.x0 && self.y0 <= other.y0 && other.x1() <= self.x1() && other.y1() <= self.y1()
    }

    /// The next coarser level's cells that lie wholly in these cells.
    #[must_use]
    pub fn coarser_cells(&self) -> Self {
        Self::between(up(self.x0), self.x1() >> 1, up(self.y0), self.y1() >> 1)
    }

    /// The next finer level's cells that make up these cells.
    #[must_use]
    pub const fn finer_cells(&self) -> Self {
        Self { x0: 2 * self.x0, y0: 2 * self.y0, nx: 2 * self.nx, ny: 2 * self.ny }
    }

    /// The nodes of these cells, all four sides included.
    #[must_use]
    pub const fn nodes(&self) -> Self {
        Self { x0: self.x0, y0: self.y0, nx: self.nx + 1, ny: self.ny + 1 }
    }

    /// The cells whose four corners are among these nodes.
    #[must_use]
    pub const fn cells(&self) -> Self {
        Self { x0: self.x0, y0: self.y0, nx: self.nx.saturating_sub(1), ny: self.ny.saturating_sub(1) }
    }
}

/// x / 2 rounded up.
const fn up(x: i32) -> i32 {
    (x + 1) >> 1
}

/// Values over a [`Window`], row by row from the south-west corner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field<T> {
    window: Window,
    data: Vec<T>,
}

impl<T: Copy + Default> Field<T> {
    /// A field of default values.
    #[must_use]
    pub fn new(window: Window) -> Self {
        Self { window, data: vec![T::default(); window.len()] }
    }

    /// A field over given values, or `None` when their number is not the window's.
    #[must_use]
    pub fn from_data(window: Window, data: Vec<T>) -> Option<Self> {
        (data.len() == window.len()).then_some(Self { window, data })
    }

    /// A field of f(x, y).
    #[must_use]
    pub fn from_fn(window: Window, mut f: impl FnMut(i32, i32) -> T) -> Self {
        let data = (window.y0..window.y1()).flat_map(|y| (window.x0..window.x1()).map(move |x| (x, y)));
        Self { window, data: data.map(|(x, y)| f(x, y)).collect() }
    }

    /// Where the values lie.
    #[must_use]
    pub const fn window(&self) -> Window {
        self.window
    }

    /// All values, row by row.
    #[must_use]
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All values, row by row, to write; bands of whole rows are contiguous.
    #[must_use]
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// The values without their window.
    #[must_use]
    pub fn into_data(self) -> Vec<T> {
        self.data
    }

    /// The value at (x, y), which must lie in the window.
    #[must_use]
    pub fn at(&self, x: i32, y: i32) -> T {
        self.row(y, x, 1)[0]
    }

    /// Writes the value at (x, y), which must lie in the window.
    pub fn put(&mut self, x: i32, y: i32, value: T) {
        let w = self.window;
        debug_assert!(w.contains(&Window::new(x, y, 1, 1)), "({x}, {y}) outside {w:?}");
        self.data[(y - w.y0) as usize * w.nx + (x - w.x0) as usize] = value;
    }

    /// `n` values of row y from column x on; all must lie in the window.
    #[must_use]
    pub fn row(&self, y: i32, x: i32, n: usize) -> &[T] {
        let w = &self.window;
        debug_assert!(w.contains(&Window::new(x, y, n, 1)), "row ({x}, {y}) + {n} outside {w:?}");
        let start = (y - w.y0) as usize * w.nx + (x - w.x0) as usize;
        &self.data[start..start + n]
    }

    /// A copy of the part in `window`, which must lie inside.
    #[must_use]
    pub fn crop(&self, window: Window) -> Self {
        let mut data = Vec::with_capacity(window.len());
        for y in window.y0..window.y1() {
            data.extend_from_slice(self.row(y, window.x0, window.nx));
        }
        Self { window, data }
    }

    /// Every second node in both directions: the nodes of the next coarser level.
    #[must_use]
    pub fn decimate(&self) -> Self {
        let w = self.window;
        let out = Window::between(up(w.x0), up(w.x1()), up(w.y0), up(w.y1()));
        let mut data = Vec::with_capacity(out.len());
        for y in out.y0..out.y1() {
            let x = 2 * out.x0;
            data.extend(self.row(2 * y, x, (w.x1() - x).max(0) as usize).iter().step_by(2));
        }
        Self { window: out, data }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimation_keeps_even_indices_on_both_signs() {
        for x0 in -3..3 {
            for nx in 1..6 {
                let field = Field::from_fn(Window::new(x0, -2, nx, 5), |x, y| 100 * y + x);
                let half = field.decimate();
                let w = half.window();
                let evens = (x0..x0 + nx as i32).filter(|x| x % 2 == 0).count();
                assert_eq!((w.nx, w.y0, w.ny), (evens, -1, 3));
                for y in w.y0..w.y1() {
                    for x in w.x0..w.x1() {
                        assert_eq!(half.at(x, y), 200 * y + 2 * x);
                    }
                }
            }
        }
    }

    #[test]
    fn windows_between_levels() {
        let cells = Window::new(-3, 2, 9, 8);
        assert_eq!(cells.coarser_cells(), Window::new(-1, 1, 4, 4));
        assert_eq!(cells.coarser_cells().finer_cells(), Window::new(-2, 2, 8, 8));
        assert_eq!(cells.nodes().cells(), cells);
        assert!(cells.expand(1).contains(&cells) && !cells.contains(&cells.expand(1)));
    }

    #[test]
    fn data_of_another_size_is_refused() {
        assert_eq!(Field::from_data(Window::new(0, 0, 2, 2), vec![1; 3]), None);
    }
}
