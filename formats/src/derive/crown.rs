//! Deviations above the coarsest stored level, so that bisection may start from whole squares.
//!
//! A file stores deviations of nodes new at levels up to the root's. The nodes that a whole map of
//! 512 x 256 (plane: 256 x 256) root cells leaves above that are few enough to be worked out when
//! the file is opened. S_0 lies within r of the flat half cells of the root level, r being the
//! smaller code of a cell's two side midpoints (saturation puts their children below them); so the
//! deviation of a coarser triangle is at most its largest distance to a root node plus the largest r.

use super::code::{decode_deviation, encode_deviation};
use crate::grid::Grid;

/// Rows of nodes of the root level, both edges included.
pub const ROWS: usize = 257;

/// Columns of nodes of the root level: 512 that wrap (globe) or 257 (plane).
#[must_use]
pub const fn columns(grid: Grid) -> usize {
    if grid.plane { 257 } else { 512 }
}

/// Fills the codes of nodes with even indices, 0 so far, with their saturated deviations.
///
/// `nodes` and `codes` are the root level's, [`ROWS`] x [`columns`], south row first. A node both of
/// whose indices are multiples of 256 is new nowhere and keeps 0.
///
/// # Panics
/// When a slice has another length.
pub fn crown(grid: Grid, nodes: &[i32], codes: &mut [u8]) {
    let columns = columns(grid);
    assert_eq!((nodes.len(), codes.len()), (ROWS * columns, ROWS * columns), "one value a node");
    let map = Map { nodes, columns, plane: grid.plane, residues: residues(grid, codes) };
    // Side midpoints of a level are children of its centres, centres of the side midpoints above.
    for shift in 1..8 {
        for centre in [false, true] {
            for (x, y) in map.new_nodes(shift, centre) {
                let own = map.deviation(x, y, 1 << shift, centre);
                let children = map.children(x, y, 1 << shift, centre);
                let below = children.iter().map(|&(x, y)| codes[map.index(x, y)]).max().unwrap_or(0);
                let index = map.index(x, y);
                codes[index] = encode_deviation((own as f32).next_up()).max(below);
            }
        }
    }
}

/// For each node how far S_0 may lie from the flat halves of the root cells about it, in height
/// units.
fn residues(grid: Grid, codes: &[u8]) -> Vec<f32> {
    let columns = columns(grid);
    let mut residues = vec![0.0f32; ROWS * columns];
    for y in 0..256 {
        for x in 0..256 << u32::from(!grid.plane) {
            let corner = |dx: usize, dy: usize| (y + dy) * columns + (x + dx) % columns;
            // The two corners with one odd index.
            let sides = if (x + y) % 2 == 0 { [corner(1, 0), corner(0, 1)] } else { [corner(0, 0), corner(1, 1)] };
            let residue = decode_deviation(codes[sides[0]].min(codes[sides[1]]));
            for k in [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)] {
                residues[k] = residues[k].max(residue);
            }
        }
    }
    residues
}

struct Map<'a> {
    nodes: &'a [i32],
    columns: usize,
    plane: bool,
    residues: Vec<f32>,
}

impl Map<'_> {
    /// Nodes new `shift` levels above the root, centres or side midpoints.
    fn new_nodes(&self, shift: u32, centre: bool) -> impl Iterator<Item = (i32, i32)> + use<> {
        let (step, columns) = (1usize << shift, self.columns);
        (0..ROWS).step_by(step).flat_map(move |y| (0..columns).step_by(step).map(move |x| (x, y))).filter_map(
            move |(x, y)| {
                let odd = ((x >> shift) & 1, (y >> shift) & 1);
                let wanted = if centre { odd == (1, 1) } else { odd.0 != odd.1 };
                wanted.then_some((x as i32, y as i32))
            },
        )
    }

    fn inside(&self, x: i32, y: i32) -> bool {
        (0..ROWS as i32).contains(&y) && (!self.plane || (0..self.columns as i32).contains(&x))
    }

    fn index(&self, x: i32, y: i32) -> usize {
        // 512 columns wrap, 257 need not.
        let column = if self.plane { x } else { x & (self.columns as i32 - 1) };
        y as usize * self.columns + column as usize
    }

    fn height(&self, x: i32, y: i32) -> f64 {
        f64::from(self.nodes[self.index(x, y)])
    }

    /// The nodes that halve the legs of the triangles about (x, y).
    fn children(&self, x: i32, y: i32, step: i32, centre: bool) -> Vec<(i32, i32)> {
        let offsets = match centre {
            true => [(step, 0), (-step, 0), (0, step), (0, -step)],
            false => [(1, 1), (1, -1), (-1, 1), (-1, -1)].map(|(a, b)| (a * step / 2, b * step / 2)),
        };
        let all = offsets.map(|(dx, dy)| (x + dx, y + dy));
        // The root's own centres' deviations are below those of its sides already.
        all.into_iter().filter(|&(x, y)| self.inside(x, y)).collect()
    }

    /// The largest distance from S_0 to the two triangles about (x, y), in height units.
    fn deviation(&self, x: i32, y: i32, step: i32, centre: bool) -> f64 {
        let triangles = match (centre, (x & step) != 0) {
            // The diagonal goes south-west to north-east where the cell's indices have an even sum.
            (true, _) if (x / (2 * step) + y / (2 * step)) % 2 == 0 => {
                [[(-step, -step), (step, step), (step, -step)], [(-step, -step), (step, step), (-step, step)]]
            }
            (true, _) => [[(step, -step), (-step, step), (step, step)], [(step, -step), (-step, step), (-step, -step)]],
            (false, true) => [[(-step, 0), (step, 0), (0, step)], [(-step, 0), (step, 0), (0, -step)]],
            (false, false) => [[(0, -step), (0, step), (step, 0)], [(0, -step), (0, step), (-step, 0)]],
        };
        triangles.into_iter().map(|corners| self.triangle(x, y, corners)).fold(0.0, f64::max)
    }

    /// The same for one triangle, corners relative to (x, y); nothing for one beyond the map.
    fn triangle(&self, x: i32, y: i32, corners: [(i32, i32); 3]) -> f64 {
        let [a, b, c] = corners.map(|(dx, dy)| (x + dx, y + dy));
        if ![a, b, c].into_iter().all(|(x, y)| self.inside(x, y)) {
            return 0.0;
        }
        let [ha, hb, hc] = [a, b, c].map(|(x, y)| self.height(x, y));
        let area = f64::from((b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1));
        let along_x = ((hb - ha) * f64::from(c.1 - a.1) - (hc - ha) * f64::from(b.1 - a.1)) / area;
        let along_y = ((hc - ha) * f64::from(b.0 - a.0) - (hb - ha) * f64::from(c.0 - a.0)) / area;
        let (mut distance, mut residue) = (0.0f64, 0.0f32);
        for v in a.1.min(b.1).min(c.1)..=a.1.max(b.1).max(c.1) {
            let (first, last) = span([a, b, c], v);
            let west = ha + along_y * f64::from(v - a.1);
            for u in first..=last {
                let k = self.index(u, v);
                distance = distance.max((f64::from(self.nodes[k]) - (west + along_x * f64::from(u - a.0))).abs());
                residue = residue.max(self.residues[k]);
            }
        }
        distance + f64::from(residue)
    }
}

/// First and last node of row v in a triangle whose sides run along rows, columns or diagonals.
fn span(corners: [(i32, i32); 3], v: i32) -> (i32, i32) {
    let (mut first, mut last) = (i32::MAX, i32::MIN);
    for (p, q) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
        let (low, high) = if p.1 <= q.1 { (p, q) } else { (q, p) };
        if (low.1..=high.1).contains(&v) {
            let x = low.0 + (high.0 - low.0).signum() * (v - low.1);
            let ends = if low.1 == high.1 { [p.0, q.0] } else { [x, x] };
            first = first.min(ends[0]).min(ends[1]);
            last = last.max(ends[0]).max(ends[1]);
        }
    }
    (first, last)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rough map whose codes of level 0 hold the twists of the cells about them, m = 8.
    fn rough(plane: bool) -> (Grid, Vec<i32>, Vec<u8>) {
        let grid = Grid::new(8, plane);
        let columns = columns(grid);
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 20) as i32 - 2048
        };
        let waves = |x: usize, y: usize| {
            let lon = x as f64 / columns as f64 * std::f64::consts::TAU;
            (3e4 * (lon.sin() + (5.0 * lon).cos() * (y as f64 / 40.0).sin())) as i32
        };
        let nodes: Vec<i32> = (0..ROWS * columns).map(|k| waves(k % columns, k / columns) + random()).collect();
        let mut codes = vec![0; nodes.len()];
        let at = |x: usize, y: usize| nodes[y * columns + x % columns];
        for y in 0..256 {
            for x in 0..columns - usize::from(plane) {
                let twist = (at(x, y) - at(x + 1, y) - at(x, y + 1) + at(x + 1, y + 1)).abs();
                let code = encode_deviation(twist as f32 / 4.0);
                for (u, v) in [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)] {
                    let k = v * columns + u % columns;
                    if (u | v) & 1 == 1 {
                        codes[k] = codes[k].max(code);
                    }
                }
            }
        }
        (grid, nodes, codes)
    }

    /// Whether a triangle of the mesh strays further from a bilinear S_0 than its node's code says.
    fn strays(grid: Grid, nodes: &[i32], codes: &[u8], shift: u32) -> bool {
        let columns = columns(grid);
        let step = 1i64 << shift;
        let height = |u: i64, v: i64| f64::from(nodes[v as usize * columns + u.rem_euclid(columns as i64) as usize]);
        let surface = |x: f64, y: f64| {
            let (u, v) = (x.floor(), y.floor().min(255.0));
            let (f, g, u, v) = (x - u, y - v, u as i64, v as i64);
            (1.0 - g) * ((1.0 - f) * height(u, v) + f * height(u + 1, v))
                + g * ((1.0 - f) * height(u, v + 1) + f * height(u + 1, v + 1))
        };
        let mut stray = false;
        let mut check = |v: (i64, i64), corners: [(i64, i64); 3]| {
            let bound =
                f64::from(decode_deviation(codes[v.1 as usize * columns + v.0.rem_euclid(columns as i64) as usize]));
            let h = corners.map(|(x, y)| height(x, y));
            for i in 0..=8 {
                for j in 0..=8 - i {
                    let w = [f64::from(i) / 8.0, f64::from(j) / 8.0, f64::from(8 - i - j) / 8.0];
                    let sum = |f: &dyn Fn(usize) -> f64| (0..3).map(|n| w[n] * f(n)).sum::<f64>();
                    let (x, y, plane) = (sum(&|n| corners[n].0 as f64), sum(&|n| corners[n].1 as f64), sum(&|n| h[n]));
                    let x = if grid.plane { x.min(255.999_999) } else { x };
                    stray |= (surface(x, y) - plane).abs() > bound + 1e-3;
                }
            }
        };
        for y in (step..256).step_by(2 * step as usize) {
            for x in (step..columns as i64 - 1).step_by(2 * step as usize) {
                let even = (x / (2 * step) + y / (2 * step)) % 2 == 0;
                let (a, b) = if even { (-step, step) } else { (step, -step) };
                check((x, y), [(x + a, y - step), (x + b, y + step), (x + step, y + if even { -step } else { step })]);
                check((x, y - step), [(x - step, y - step), (x + step, y - step), (x, y)]);
                check((x - step, y), [(x - step, y - step), (x - step, y + step), (x, y)]);
            }
        }
        stray
    }

    #[test]
    fn the_codes_bound_a_rough_surface_and_are_saturated() {
        for plane in [false, true] {
            let (grid, nodes, mut codes) = rough(plane);
            crown(grid, &nodes, &mut codes);
            for shift in 1..8 {
                assert!(!strays(grid, &nodes, &codes, shift), "plane {plane}, {shift} levels up");
            }
            let map = Map { nodes: &nodes, columns: columns(grid), plane, residues: Vec::new() };
            for (shift, centre) in (1..8).flat_map(|s| [(s, false), (s, true)]) {
                for (x, y) in map.new_nodes(shift, centre) {
                    for (u, v) in map.children(x, y, 1 << shift, centre) {
                        assert!(codes[map.index(x, y)] >= codes[map.index(u, v)]);
                    }
                }
            }
        }
    }

    #[test]
    fn the_check_finds_codes_that_are_too_small() {
        let (grid, nodes, mut codes) = rough(false);
        crown(grid, &nodes, &mut codes);
        let lowered: Vec<u8> = codes.iter().map(|c| c.saturating_sub(6)).collect();
        assert!((1..8).any(|shift| strays(grid, &nodes, &lowered, shift)));
    }
}
