//! Slow truths in f64 that share no code with what they judge, and the heights they judge it on.

use super::block::{Base, derive_block};
use super::code::decode_deviation;
use super::field::{Field, Window};
use std::collections::HashMap;

/// Level-0 heights over a padded square, asked for by map indices.
pub(super) type Heights = Field<i32>;

/// A number that looks random, the same on every machine.
pub(super) fn noise(x: i32, y: i32, seed: u64) -> u64 {
    let mut z = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    z = z.wrapping_add(seed.wrapping_mul(0x1656_67b1_9e37_79f9));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Sums of smoothed value noise: each octave half as wide and `rough` as high as the one before.
pub(super) fn terrain(window: Window, rough: f64, seed: u64) -> Heights {
    let value = |x: i32, y: i32, octave: i32| {
        let size = 1 << octave;
        let (cx, cy) = (x.div_euclid(size), y.div_euclid(size));
        let smooth = |v: i32| {
            let f = f64::from(v.rem_euclid(size)) / f64::from(size);
            f * f * (3.0 - 2.0 * f)
        };
        let (fx, fy) = (smooth(x), smooth(y));
        let at = |dx, dy| (noise(cx + dx, cy + dy, seed + octave as u64) % 2001) as f64 / 1000.0 - 1.0;
        (at(0, 0) * (1.0 - fx) + at(1, 0) * fx) * (1.0 - fy) + (at(0, 1) * (1.0 - fx) + at(1, 1) * fx) * fy
    };
    Field::from_fn(window, |x, y| {
        (0..9).map(|o| 3000.0 * rough.powi(8 - o) * value(x, y, o)).sum::<f64>().round() as i32
    })
}

fn height(h: &Heights, x: i32, y: i32) -> f64 {
    f64::from(h.at(x, y))
}

/// S_0 at any point: bilinear in its cell.
fn surface(h: &Heights, x: f64, y: f64) -> f64 {
    let w = h.window();
    let (i, j) = ((x.floor() as i32).min(w.x1() - 2), (y.floor() as i32).min(w.y1() - 2));
    let (s, t) = (x - f64::from(i), y - f64::from(j));
    let south = height(h, i, j) * (1.0 - s) + height(h, i + 1, j) * s;
    let north = height(h, i, j + 1) * (1.0 - s) + height(h, i + 1, j + 1) * s;
    south * (1.0 - t) + north * t
}

/// The largest |S_0 - plane| over a triangle, its corners in parts of a cell, `parts` to each: all
/// nodes in it, and points along its three edges (each crosses a cell's interior only on a diagonal,
/// or the triangle lies in one cell, where S_0 - plane is a saddle).
pub(super) fn distance(h: &Heights, corners: [(i32, i32); 3], parts: i32) -> f64 {
    let [a, b, c] = corners.map(|(x, y)| {
        let (x, y) = (f64::from(x) / f64::from(parts), f64::from(y) / f64::from(parts));
        (x, y, surface(h, x, y))
    });
    let det = (b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1);
    let gap = |x: f64, y: f64| {
        let v = ((x - a.0) * (c.1 - a.1) - (c.0 - a.0) * (y - a.1)) / det;
        let w = ((b.0 - a.0) * (y - a.1) - (x - a.0) * (b.1 - a.1)) / det;
        let inside = v > -1e-9 && w > -1e-9 && v + w < 1.0 + 1e-9;
        inside.then(|| (surface(h, x, y) - (a.2 + v * (b.2 - a.2) + w * (c.2 - a.2))).abs())
    };
    let mut largest = 0f64;
    let range = |f: fn(&(i32, i32)) -> i32| {
        let low = corners.iter().map(f).min().unwrap().div_euclid(parts);
        low..=corners.iter().map(f).max().unwrap().div_euclid(parts)
    };
    for y in range(|p| p.1) {
        for x in range(|p| p.0) {
            largest = largest.max(gap(f64::from(x), f64::from(y)).unwrap_or(0.0));
        }
    }
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let steps = 8 * (q.0 - p.0).abs().max((q.1 - p.1).abs()).ceil() as i32;
        for s in 0..=steps {
            let f = f64::from(s) / f64::from(steps);
            let d = gap(p.0 + f * (q.0 - p.0), p.1 + f * (q.1 - p.1));
            largest = largest.max(d.expect("a point of an edge lies in its triangle"));
        }
    }
    largest
}

/// The two triangles that node (i, j) of level k parts, apex last, in level-0 indices; with k
/// counted from a virtual level on, in its parts of a cell.
pub(super) fn triangles(k: u32, i: i32, j: i32) -> [[(i32, i32); 3]; 2] {
    let at = |x: i32, y: i32| (x << k, y << k);
    let (odd_x, odd_y) = (i.rem_euclid(2) == 1, j.rem_euclid(2) == 1);
    assert!(odd_x || odd_y, "({i}, {j}) is not new at level {k}");
    let (w, e, s, n) = (i - 1, i + 1, j - 1, j + 1);
    if odd_x && odd_y {
        // Corners whose indices at level k + 1 have an even sum end the diagonal.
        if (w / 2 + s / 2).rem_euclid(2) == 0 {
            [[at(w, s), at(e, n), at(e, s)], [at(w, s), at(e, n), at(w, n)]]
        } else {
            [[at(e, s), at(w, n), at(w, s)], [at(e, s), at(w, n), at(e, n)]]
        }
    } else if odd_x {
        [[at(w, j), at(e, j), at(i, s)], [at(w, j), at(e, j), at(i, n)]]
    } else {
        [[at(i, s), at(i, n), at(w, j)], [at(i, s), at(i, n), at(e, j)]]
    }
}

/// A node of a level; level -1 is the first below level 0.
type Node = (i32, i32, i32);

/// True deviations, each worked out once.
pub(super) struct Truth<'a> {
    heights: &'a Heights,
    depth: i32,
    own: HashMap<Node, f64>,
    saturated: HashMap<Node, f64>,
}

impl<'a> Truth<'a> {
    /// `depth` levels below level 0 count.
    pub(super) fn new(heights: &'a Heights, depth: i32) -> Self {
        Self { heights, depth, own: HashMap::new(), saturated: HashMap::new() }
    }

    /// In parts of a cell of level 0, 2^`depth` to each.
    fn triangles(&self, (k, i, j): Node) -> [[(i32, i32); 3]; 2] {
        triangles((k + self.depth) as u32, i, j)
    }

    /// The largest distance over the node's own two triangles.
    pub(super) fn own(&mut self, node: Node) -> f64 {
        let (heights, triangles, parts) = (self.heights, self.triangles(node), 1 << self.depth);
        *self
            .own
            .entry(node)
            .or_insert_with(|| triangles.map(|t| distance(heights, t, parts)).into_iter().fold(0.0, f64::max))
    }

    /// Not below those of its children: for each triangle (a, b, apex), the middles of its legs.
    pub(super) fn saturated(&mut self, (k, i, j): Node) -> f64 {
        if let Some(&d) = self.saturated.get(&(k, i, j)) {
            return d;
        }
        let mut d = self.own((k, i, j));
        for [a, b, apex] in self.triangles((k, i, j)) {
            for end in [a, b] {
                let sum = (end.0 + apex.0, end.1 + apex.1);
                if sum.0 % 2 == 0 && sum.1 % 2 == 0 {
                    let (x, y) = (sum.0 / 2, sum.1 / 2);
                    let up = (x | y).trailing_zeros() as i32;
                    d = d.max(self.saturated((up - self.depth, x >> up, y >> up)));
                }
            }
        }
        self.saturated.insert((k, i, j), d);
        d
    }
}

/// Derives `levels` levels of `heights` over `core` and compares every code with the truth. Returns, per
/// level, the mean ratio of decoded to true deviations over nodes whose true one exceeds 1 unit.
pub(super) fn judge(heights: &Heights, core: Window, levels: u32) -> Vec<f64> {
    let base = Base { level: 0, nodes: heights.clone(), mip: None, below: None };
    let block = derive_block(base, core, levels, None);
    let mut truth = Truth::new(heights, 2);
    block.levels.iter().map(|plane| ratio(plane.level, &plane.deviations, &mut truth)).collect()
}

/// [`judge`] for one plane of codes.
pub(super) fn ratio(level: u32, codes: &Field<u8>, truth: &mut Truth<'_>) -> f64 {
    let w = codes.window();
    let (mut sum, mut count) = (0.0, 0);
    for j in w.y0..w.y1() {
        for i in w.x0..w.x1() {
            if (i | j) % 2 == 0 {
                assert_eq!(codes.at(i, j), 0, "({i}, {j}) is not new at level {level}");
                continue;
            }
            let bound = f64::from(decode_deviation(codes.at(i, j)));
            let exact = truth.saturated((level as i32, i, j));
            assert!(bound >= exact - 1e-9, "level {level} ({i}, {j}): bound {bound} below {exact}");
            assert!(exact > 0.0 || bound < 1.0, "level {level} ({i}, {j}): {bound} where all is plane");
            if exact > 1.0 {
                sum += bound / exact;
                count += 1;
            }
        }
    }
    if count == 0 { 1.0 } else { sum / f64::from(count) }
}
