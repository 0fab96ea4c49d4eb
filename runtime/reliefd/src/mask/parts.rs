//! A mask in parts: few pages do for the rays of one.

use relief_formats::grid::Grid;
use relief_front::window::Rectangle;
use relief_runtime::shadow::ShadowWindow;

/// A part of a rectangle of nodes.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// What is cast.
    pub window: ShadowWindow,
    /// Column in the rectangle.
    x: u32,
    /// Row in the rectangle, southernmost first.
    y: u32,
}

/// The parts of a rectangle of a level's nodes, at most `side` nodes a side; `like` holds sun, air and
/// level.
pub fn parts(rectangle: Rectangle, grid: Grid, like: ShadowWindow, side: u32) -> impl Iterator<Item = Part> {
    let columns = i64::from(grid.width(like.level));
    let rows = (0..rectangle.rows).step_by(side as usize);
    rows.flat_map(move |y| (0..rectangle.columns).step_by(side as usize).map(move |x| (x, y))).map(move |(x, y)| Part {
        window: ShadowWindow {
            x: (rectangle.column + i64::from(x)).rem_euclid(columns) as u32,
            y: rectangle.row + y,
            columns: side.min(rectangle.columns - x),
            rows: side.min(rectangle.rows - y),
            ..like
        },
        x,
        y,
    })
}

/// A mask that its parts are put into: rows from the north.
pub struct Whole {
    rectangle: Rectangle,
    lit: Vec<u8>,
}

impl Whole {
    /// In shadow all over.
    pub fn new(rectangle: Rectangle) -> Self {
        Self { rectangle, lit: vec![0; rectangle.columns as usize * rectangle.rows as usize] }
    }

    /// Puts a part's nodes in, row by row from the south.
    pub fn put(&mut self, part: &Part, lit: &[u8]) {
        let stride = self.rectangle.columns as usize;
        for (k, lit) in (0..).zip(lit.chunks_exact(part.window.columns as usize)) {
            let row = (self.rectangle.rows - 1 - part.y - k) as usize;
            self.lit[row * stride + part.x as usize..][..lit.len()].copy_from_slice(lit);
        }
    }

    /// The visible part of the sun, 0 to 255, row by row from the north.
    pub fn into_lit(self) -> Vec<u8> {
        self.lit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every node once, at its place, across the seam too.
    #[test]
    fn parts_make_up_the_whole() {
        let grid = Grid::new(11, false);
        let rectangle = Rectangle { column: -700, row: 5, columns: 1100, rows: 600 };
        let mut whole = Whole::new(rectangle);
        let like = ShadowWindow { level: 1, ..ShadowWindow::default() };
        let mark = |column: u32, row: u32| ((column * 31 + row * 17) % 251) as u8 + 1;
        let mut count = 0;
        for part in parts(rectangle, grid, like, 256) {
            let ShadowWindow { x, y, columns, rows, level, .. } = part.window;
            assert!(level == 1 && columns <= 256 && rows <= 256 && x < 2048);
            let nodes = (y..y + rows).flat_map(|y| (x..x + columns).map(move |x| mark(x % 2048, y)));
            whole.put(&part, &nodes.collect::<Vec<_>>());
            count += columns * rows;
        }
        assert_eq!(count, 1100 * 600);
        for (k, lit) in (0u32..).zip(whole.into_lit()) {
            let (column, row) = (k % 1100, 599 - k / 1100);
            assert_eq!(lit, mark((column + 2048 - 700) % 2048, row + 5), "{column} {row}");
        }
    }
}
