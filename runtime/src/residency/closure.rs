//! What a page rests on.

use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;

/// All tiles of a level.
pub(super) fn level(grid: Grid, level: u32) -> impl Iterator<Item = TileKey> {
    let (columns, rows) = (grid.tiles_x(level), grid.tiles_y(level));
    (0..rows).flat_map(move |y| (0..columns).map(move |x| TileKey::new(level, x, y)))
}

/// The tiles of the next coarser level that touch a tile's closed area: its parent and the up to
/// three on the parent's sides that it shares. The seam is crossed, a pole is not.
pub(super) fn touching(grid: Grid, key: TileKey) -> Vec<TileKey> {
    if key.level >= grid.root_level() {
        return Vec::new();
    }
    let level = key.level + 1;
    let columns = grid.tiles_x(level);
    let side = |quadrant: usize| if quadrant == 0 { -1 } else { 1 };
    let x = i64::from(key.x / 2);
    let y = i64::from(key.y / 2);
    let beside = x + side(key.quadrant().0);
    let beside = match grid.plane {
        true => (0..i64::from(columns)).contains(&beside).then_some(beside),
        false => Some(beside.rem_euclid(i64::from(columns))),
    };
    let above = y + side(key.quadrant().1);
    let above = (0..i64::from(grid.tiles_y(level))).contains(&above).then_some(above);
    let mut tiles = Vec::with_capacity(4);
    for y in [Some(y), above].into_iter().flatten() {
        for x in [Some(x), beside].into_iter().flatten() {
            tiles.push(TileKey::new(level, x as u32, y as u32));
        }
    }
    tiles
}

/// The tile of the same level some columns and rows on. The seam is crossed, a pole is not.
pub(super) fn beside(grid: Grid, key: TileKey, dx: i64, dy: i64) -> Option<TileKey> {
    let (columns, rows) = (i64::from(grid.tiles_x(key.level)), i64::from(grid.tiles_y(key.level)));
    let (x, y) = (i64::from(key.x) + dx, i64::from(key.y) + dy);
    let x = if grid.plane { x } else { x.rem_euclid(columns) };
    ((0..columns).contains(&x) && (0..rows).contains(&y)).then(|| TileKey::new(key.level, x as u32, y as u32))
}

/// The tiles of the next finer level that touch a tile's closed area.
pub(super) fn within_and_about(grid: Grid, key: TileKey) -> impl Iterator<Item = TileKey> {
    let first = key.level.checked_sub(1).map(|level| TileKey::new(level, 2 * key.x, 2 * key.y));
    let around = (-1..=2).flat_map(|dy| (-1..=2).map(move |dx| (dx, dy)));
    first.into_iter().flat_map(move |first| around.clone().filter_map(move |(dx, dy)| beside(grid, first, dx, dy)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_seam_is_crossed_and_the_poles_are_not() {
        let globe = Grid::new(10, false);
        let keys = |grid, key| touching(grid, key).into_iter().map(|k| (k.x, k.y)).collect::<Vec<_>>();
        assert_eq!(keys(globe, TileKey::new(0, 0, 0)), [(0, 0), (3, 0)]);
        assert_eq!(keys(globe, TileKey::new(0, 7, 1)), [(3, 0), (0, 0), (3, 1), (0, 1)]);
        assert_eq!(keys(globe, TileKey::new(2, 1, 0)), []);
        let plane = Grid::new(10, true);
        assert_eq!(keys(plane, TileKey::new(0, 0, 2)), [(0, 1), (0, 0)]);
    }

    proptest! {
        /// Against areas in level-0 cells: closed squares that share a point.
        #[test]
        fn they_are_those_whose_closed_areas_meet(m in 9u32..14, level in 0u32..4, pick: u32, plane: bool) {
            let grid = Grid::new(m, plane);
            prop_assume!(level < grid.root_level());
            let tiles = grid.tiles_x(level) * grid.tiles_y(level);
            let key = TileKey::new(level, pick % tiles % grid.tiles_x(level), pick % tiles / grid.tiles_x(level));
            let meets = |other: &TileKey| {
                let (a, b) = (256i64 << key.level, 256i64 << other.level);
                let (w, x, y) = (i64::from(grid.width(0)), i64::from(key.x) * a, i64::from(key.y) * a);
                let rows = y <= (i64::from(other.y) + 1) * b && y + a >= i64::from(other.y) * b;
                let turns: &[i64] = if plane { &[0] } else { &[-1, 0, 1] };
                rows && turns.iter().any(|turn| {
                    let start = i64::from(other.x) * b + turn * w;
                    x <= start + b && x + a >= start
                })
            };
            let mut expected: Vec<TileKey> = super::level(grid, level + 1).filter(meets).collect();
            let mut found = touching(grid, key);
            expected.sort();
            found.sort();
            found.dedup();
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn those_within_and_about_are_those_that_touch(m in 9u32..13, level in 1u32..4, pick: u32, plane: bool) {
            let grid = Grid::new(m, plane);
            prop_assume!(level <= grid.root_level());
            let (columns, rows) = (grid.tiles_x(level), grid.tiles_y(level));
            let key = TileKey::new(level, pick % columns, (pick >> 8) % rows);
            let mut found: Vec<TileKey> = within_and_about(grid, key).collect();
            let mut expected: Vec<TileKey> =
                super::level(grid, level - 1).filter(|&finer| touching(grid, finer).contains(&key)).collect();
            expected.sort();
            found.sort();
            found.dedup();
            prop_assert_eq!(found, expected);
        }
    }
}
