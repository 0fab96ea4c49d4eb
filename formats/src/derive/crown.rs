//! Deviations above the coarsest stored level, so that bisection may start from whole squares.
//!
//! A file's root level has 512 x 256 (plane: 256 x 256) cells. The nodes that are new at the seven
//! levels above it are the root level's nodes with two even indices, whose codes are free. They
//! are worked out like all others, from what the last stage hands on.

use super::block::{Base, Below, derive_block, padding};
use super::distances::CellDistances;
use super::field::{Field, Window};
use crate::grid::Grid;

/// Levels above the root's with new nodes: the map is 2 x 1 (plane: 1 x 1) cells of the last one's.
pub const LEVELS: u32 = 7;

/// Codes of the root level's nodes that are new above it; 0 at all others. `parts` are what the
/// last stage's blocks hand on, of level root + 1; side by side they are the whole map.
///
/// # Panics
/// When the parts leave some of the map out.
#[must_use]
pub fn crown(grid: Grid, parts: &[&Base]) -> Field<u8> {
    let level = grid.root_level() + 1;
    let core = Window::new(0, 0, grid.width(level) as usize, grid.height(level) as usize);
    let mut codes = Field::new(core.finer_cells().nodes());
    for (shift, planes) in (1..).zip(derive_block(continued(grid, parts, core), core, LEVELS, None).levels) {
        let nodes = Window::between(0, core.x1() >> (shift - 1), 0, core.y1() >> (shift - 1)).nodes();
        for (x, y) in (0..nodes.ny as i32).flat_map(|y| (0..nodes.nx as i32).map(move |x| (x, y))) {
            codes.put(x << shift, y << shift, planes.deviations.at(x, y));
        }
    }
    codes
}

/// Puts the crown's codes into the root level's, at the nodes with two even indices.
pub fn lay(crown: &Field<u8>, codes: &mut Field<u8>) {
    let (w, map) = (codes.window(), crown.window());
    for (x, y) in (w.y0..w.y1()).flat_map(|y| (w.x0..w.x1()).map(move |x| (x, y))) {
        if (x | y) & 1 == 0 && map.contains(&Window::new(x, y, 1, 1)) {
            codes.put(x, y, crown.at(x, y));
        }
    }
}

/// The parts as one base, continued beyond the map's edge.
fn continued(grid: Grid, parts: &[&Base], core: Window) -> Base {
    let level = grid.root_level() + 1;
    let window = core.expand(padding(LEVELS));
    let node = |x: i32, y: i32| {
        let (x, y) = grid.home_node(level, x, y);
        held(parts.iter().map(|part| &part.nodes), x, y)
    };
    let below: Vec<&Below> = parts.iter().filter_map(|part| part.below.as_ref()).collect();
    let interval = |x: i32, y: i32| {
        let (x, y) = grid.home_cell(level, x, y);
        held(below.iter().map(|part| &part.intervals), x, y)
    };
    let centre = |x: i32, y: i32| {
        let (x, y) = grid.home_cell(level, x, y);
        held(below.iter().map(|part| &part.centres), x, y)
    };
    let known = below.iter().map(|part| part.distances.len()).min().unwrap_or(0);
    let below = Below {
        intervals: Field::from_fn(window, interval),
        extremes: Field::new(core),
        centres: Field::from_fn(window, centre),
        distances: (0..known).map(|index| distances(grid, &below, window, index)).collect(),
    };
    Base { level, nodes: Field::from_fn(window.nodes(), node), mip: None, below: Some(below) }
}

/// The value at (x, y) of the first field that has it.
fn held<'a, T: Copy + Default + 'a>(mut fields: impl Iterator<Item = &'a Field<T>>, x: i32, y: i32) -> T {
    let here = Window::new(x, y, 1, 1);
    let field = fields.find(|field| field.window().contains(&here));
    field.unwrap_or_else(|| panic!("no part of the map holds ({x}, {y})")).at(x, y)
}

/// Distances about the map, 0 where no triangle lies: beyond a pole or a plane's edge.
fn distances(grid: Grid, parts: &[&Below], window: Window, index: usize) -> Field<CellDistances> {
    let up = index as u32 + 1;
    let level = grid.root_level() + 1 + up;
    let (w, h) = (grid.width(level) as i32, grid.height(level) as i32);
    let window = Window::between(window.x0 >> up, window.x1() >> up, window.y0 >> up, window.y1() >> up);
    Field::from_fn(window, |x, y| {
        let on_map = (0..h).contains(&y) && (!grid.plane || (0..w).contains(&x));
        match on_map {
            true => held(parts.iter().map(|part| &part.distances[index]), x.rem_euclid(w), y),
            false => CellDistances::default(),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::block::Block;
    use super::super::code::decode_deviation;
    use super::super::oracle::{distance, terrain, triangles};
    use super::*;

    /// The block of a whole map, its heights continued beyond the edge, and those heights.
    fn whole(grid: Grid, rough: f64) -> (Block, Field<i32>) {
        let core = Window::new(0, 0, grid.width(0) as usize, grid.height(0) as usize);
        let mut map = terrain(core.nodes(), rough, 7);
        for x in 0..=core.x1() {
            map.put(x, 0, -400);
            map.put(x, core.y1(), 900);
        }
        let heights = Field::from_fn(core.expand(core.y1()).nodes(), |x, y| {
            let (x, y) = grid.home_node(0, x, y);
            map.at(x, y)
        });
        let levels = grid.root_level() + 1;
        let nodes = heights.crop(core.expand(padding(levels)).nodes());
        let mut block = derive_block(Base { level: 0, nodes, mip: None, below: None }, core, levels, None);
        let codes = crown(grid, &[&block.next]);
        lay(&codes, &mut block.levels[grid.root_level() as usize].deviations);
        (block, heights)
    }

    /// Nodes that are new `shift` levels above the root, in its indices.
    fn new_nodes(grid: Grid, shift: u32) -> impl Iterator<Item = (i32, i32)> {
        let root = grid.root_level();
        let line = move |cells: u32| (0..=cells as i32).step_by(1 << shift);
        let all = line(grid.height(root)).flat_map(move |y| line(grid.width(root)).map(move |x| (x, y)));
        all.filter(move |(x, y)| ((x | y) >> shift) & 1 == 1)
    }

    /// The nodes that halve the legs of a node's triangles, but for those beyond the map.
    fn children(grid: Grid, (x, y): (i32, i32)) -> impl Iterator<Item = (i32, i32)> {
        let n = 1i32 << (x | y).trailing_zeros();
        let offsets = match x & y & n != 0 {
            true => [(n, 0), (-n, 0), (0, n), (0, -n)],
            false => [(1, 1), (1, -1), (-1, 1), (-1, -1)].map(|(u, v)| (u * n / 2, v * n / 2)),
        };
        let (w, h) = (grid.width(grid.root_level()) as i32, grid.height(grid.root_level()) as i32);
        offsets
            .map(|(u, v)| (x + u, y + v))
            .into_iter()
            .filter(move |&(x, y)| (0..=w).contains(&x) && (0..=h).contains(&y))
    }

    /// Compares the codes of a shift with the truth about the triangles on the map. Returns the
    /// mean ratio of a code's bound to the larger of that and its children's bounds.
    fn judge(grid: Grid, heights: &Field<i32>, codes: &Field<u8>, shift: u32) -> f64 {
        let (root, last) = (grid.root_level(), (grid.width(0) as i32, grid.height(0) as i32));
        let bound = |(x, y)| f64::from(decode_deviation(codes.at(x, y)));
        let (mut sum, mut count) = (0.0, 0);
        for (x, y) in new_nodes(grid, shift) {
            let on_map =
                |t: &[(i32, i32); 3]| t.iter().all(|c| (0..=last.0).contains(&c.0) && (0..=last.1).contains(&c.1));
            let triangles = triangles(root + shift, x >> shift, y >> shift).into_iter().filter(on_map);
            let own = triangles.map(|t| distance(heights, t, 1)).fold(0.0, f64::max);
            assert!(bound((x, y)) >= own - 1e-9, "({x}, {y}): bound {} below {own}", bound((x, y)));
            let least = children(grid, (x, y)).map(bound).fold(own, f64::max);
            if least > 1.0 {
                sum += bound((x, y)) / least;
                count += 1;
            }
        }
        sum / f64::from(count)
    }

    fn root_codes(grid: Grid, block: &Block) -> Field<u8> {
        let root = grid.root_level();
        let cells = Window::new(0, 0, grid.width(root) as usize, grid.height(root) as usize);
        block.levels[root as usize].deviations.crop(cells.nodes())
    }

    #[test]
    fn codes_hold_the_truth_and_are_tight() {
        for (m, is_plane, rough) in [(8, false, 0.5), (9, true, 0.8), (9, false, 0.35)] {
            let grid = Grid::new(m, is_plane);
            let (block, heights) = whole(grid, rough);
            let codes = root_codes(grid, &block);
            for shift in 1..=LEVELS {
                let mean = judge(grid, &heights, &codes, shift);
                assert!((1.0..1.2).contains(&mean), "m {m}, plane {is_plane}, {shift} levels up: {mean}");
            }
        }
    }

    #[test]
    #[should_panic(expected = "bound")]
    fn a_code_too_low_is_caught() {
        let grid = Grid::new(8, true);
        let (block, heights) = whole(grid, 0.5);
        let mut lowered = root_codes(grid, &block);
        for code in lowered.data_mut() {
            *code = code.saturating_sub(3);
        }
        judge(grid, &heights, &lowered, 3);
    }

    #[test]
    fn no_node_is_below_its_children() {
        let grid = Grid::new(9, false);
        let codes = root_codes(grid, &whole(grid, 0.8).0);
        for node in (1..=LEVELS).flat_map(|shift| new_nodes(grid, shift)) {
            for (u, v) in children(grid, node) {
                assert!(codes.at(u, v) <= codes.at(node.0, node.1), "({u}, {v}) above {node:?}");
            }
        }
    }

    #[test]
    fn parts_do_not_show() {
        let grid = Grid::new(8, false);
        let next = whole(grid, 0.6).0.next;
        let window = next.nodes.window().cells();
        let part = |x: usize| {
            let cells = Window::new((x * window.nx / 2) as i32, 0, window.nx / 2, window.ny);
            let below = next.below.as_ref().unwrap();
            let halved = |f: &Field<CellDistances>| {
                let w = f.window();
                f.crop(Window::new((x * w.nx / 2) as i32, 0, w.nx / 2, w.ny))
            };
            let below = Below {
                intervals: below.intervals.crop(cells),
                extremes: below.extremes.crop(cells),
                centres: below.centres.crop(cells),
                distances: below.distances.iter().map(halved).collect(),
            };
            Base { level: next.level, nodes: next.nodes.crop(cells.nodes()), mip: None, below: Some(below) }
        };
        assert_eq!(crown(grid, &[&part(0), &part(1)]), crown(grid, &[&next]));
    }
}
