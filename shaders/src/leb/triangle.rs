//! Triangles of longest-edge bisection on the node grid (the 4-8 mesh).
//!
//! A triangle is named by the midpoint v of its hypotenuse, the step of v (2^exponent units; v is
//! new at level k = exponent - 31 + m) and the direction from v to the right-angled apex. The
//! apex lies one step away, the hypotenuse's ends as far to both sides. v with both coordinates odd
//! in steps is the centre of a cell and its apex diagonal; else v halves a cell's side.

use bytemuck::{Pod, Zeroable};

/// East, north-east, north ... south-east: columns and rows to go.
pub const DIRECTIONS: [[i32; 2]; 8] = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];

/// `struct Triangle` of `wgsl/lib/leb_triangle.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Pod, Zeroable)]
pub struct Triangle {
    /// The hypotenuse's midpoint in fixed point.
    pub s: u32,
    /// The hypotenuse's midpoint in fixed point.
    pub t: u32,
    /// Exponent of the step times 8, and the apex' direction, an index of [`DIRECTIONS`].
    pub code: u32,
}

/// A node that halves hypotenuses, without the triangle that asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node {
    /// Fixed point.
    pub s: u32,
    /// Fixed point.
    pub t: u32,
    /// The step is 2^exponent units.
    pub exponent: u32,
    /// True at the centre of a cell, false on a side.
    pub centre: bool,
}

impl Node {
    /// Units to the apexes' columns and rows.
    #[must_use]
    pub fn step(&self) -> u32 {
        1 << self.exponent
    }

    /// Its place in the order of bisection: parents have more than their children.
    #[must_use]
    pub fn rank(&self) -> u32 {
        2 * self.exponent + u32::from(self.centre)
    }

    /// Half the hypotenuse, in units.
    #[must_use]
    pub fn half_hypotenuse(&self) -> f32 {
        let step = self.step() as f32;
        if self.centre { std::f32::consts::SQRT_2 * step } else { step }
    }

    /// How far the nodes below it, and so all their triangles, may lie from it, in units: steps
    /// of 1 from a centre to a side and of sqrt(1/2) from there to the next centre, halved for ever.
    #[must_use]
    pub fn subtree_radius(&self) -> f32 {
        let step = self.step() as f32;
        if self.centre { 3.414_213_7 * step } else { 2.414_213_7 * step }
    }

    /// The same in the larger of columns and rows.
    #[must_use]
    pub fn subtree_half_width(&self) -> u32 {
        (2 + u32::from(self.centre)) << self.exponent
    }
}

impl Triangle {
    /// A triangle by its midpoint, step and apex.
    #[must_use]
    pub fn new(s: u32, t: u32, exponent: u32, direction: u32) -> Self {
        Self { s, t, code: exponent << 3 | direction }
    }

    /// The node that would halve it.
    #[must_use]
    pub fn node(&self) -> Node {
        Node { s: self.s, t: self.t, exponent: self.code >> 3, centre: self.code & 1 == 1 }
    }

    /// Corners (S, T), counter-clockwise seen from outside: the apex, then the hypotenuse.
    #[must_use]
    pub fn corners(&self) -> [[u32; 2]; 3] {
        let exponent = self.code >> 3;
        [0, 2, 6].map(|turn| step_from(self.s, self.t, exponent, self.code + turn))
    }

    /// False where the halves' midpoints would not be whole units.
    #[must_use]
    pub fn divisible(&self) -> bool {
        self.code & 1 == 1 || self.code >> 3 > 0
    }

    /// The two halves; only of a divisible one.
    #[must_use]
    pub fn halves(&self) -> [Self; 2] {
        let exponent = (self.code >> 3) - (1 - (self.code & 1));
        [(1, 5), (7, 3)].map(|(turn, back)| {
            let [s, t] = step_from(self.s, self.t, exponent, self.code + turn);
            Self::new(s, t, exponent, (self.code + back) & 7)
        })
    }

    /// The node whose activity made this triangle: the apex halves the parent's hypotenuse.
    #[must_use]
    pub fn parent(&self) -> Node {
        let [[s, t], ..] = self.corners();
        let node = self.node();
        Node { s, t, exponent: node.exponent + u32::from(node.centre), centre: !node.centre }
    }
}

/// One step of 2^exponent units from (s, t) in a direction, taken modulo 8.
fn step_from(s: u32, t: u32, exponent: u32, direction: u32) -> [u32; 2] {
    let [x, y] = DIRECTIONS[direction as usize & 7];
    [s.wrapping_add((x as u32) << exponent), t.wrapping_add((y as u32) << exponent)]
}

/// Exponent of the start's steps: cells of 1/8 turn (a plane: half its side).
#[must_use]
pub fn start_exponent(plane: bool) -> u32 {
    if plane { 29 } else { 28 }
}

/// Triangles to start with, at most.
pub const START_MOST: u32 = 64;

/// How many triangles there are to start with.
#[must_use]
pub fn start_count(plane: bool) -> u32 {
    if plane { 8 } else { START_MOST }
}

/// Triangle `index` of the start: cells row by row, two in each. A cell's diagonal runs from
/// south-west to north-east where its indices have an even sum.
#[must_use]
pub fn start(plane: bool, index: u32) -> Triangle {
    let (exponent, columns) = (start_exponent(plane), if plane { 2 } else { 8 });
    let (x, y) = (index / 2 % columns, index / 2 / columns);
    let direction = if (x + y) % 2 == 0 { 3 } else { 1 } + 4 * (index % 2);
    Triangle::new((2 * x + 1) << exponent, (2 * y + 1) << exponent, exponent, direction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    #[test]
    fn the_start_covers_the_map_once() {
        for plane in [false, true] {
            let mut edges: HashMap<[[u32; 2]; 2], i32> = HashMap::new();
            let mut area = 0;
            for triangle in (0..start_count(plane)).map(|i| start(plane, i)) {
                let corners = triangle.corners();
                for k in 0..3 {
                    let (a, b) = (corners[k], corners[(k + 1) % 3]);
                    *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
                }
                area += 1u64 << (2 * (triangle.code >> 3) + 1);
            }
            assert_eq!(area, if plane { 1 << 62 } else { 1 << 63 });
            // Inner edges run both ways; what is left lies on the map's border.
            let border = |[a, b]: &[[u32; 2]; 2]| {
                a[1] == b[1] && (a[1] == 0 || a[1] == 1 << 31)
                    || plane && a[0] == b[0] && (a[0] == 0 || a[0] == 1 << 31)
            };
            assert!(edges.iter().all(|(edge, &sum)| (sum == 0) != border(edge)), "{edges:?}");
        }
    }

    proptest! {
        #[test]
        fn halves_are_right_and_cover_their_parent(index in 0u32..64, path: u64) {
            let mut triangle = start(false, index);
            for depth in 0..57 {
                let [a, b] = triangle.halves();
                let (node, corners) = (triangle.node(), triangle.corners());
                for half in [a, b] {
                    prop_assert_eq!(half.parent(), node);
                    prop_assert!(half.node().rank() == node.rank() - 1);
                    prop_assert_eq!(half.corners()[0], [triangle.s, triangle.t]);
                    // Both coordinates odd in steps: a centre; else exactly one is.
                    let [i, j] = [half.s, half.t].map(|v| v >> half.node().exponent & 1);
                    prop_assert_eq!(i + j, 1 + u32::from(half.node().centre));
                    prop_assert_eq!([half.s, half.t].map(|v| v & (half.node().step() - 1)), [0, 0]);
                }
                // Counter-clockwise: apex, first end, second end; the first half keeps the first end.
                prop_assert_eq!([a.corners()[1], a.corners()[2]], [corners[0], corners[1]]);
                prop_assert_eq!([b.corners()[1], b.corners()[2]], [corners[2], corners[0]]);
                if node.centre {
                    let cell = [triangle.s, triangle.t].map(|v| v >> (node.exponent + 1) & 1);
                    let rising = triangle.code & 3 == 3;
                    prop_assert_eq!(rising, (cell[0] + cell[1]) % 2 == 0, "the diagonals' rule of the files");
                }
                triangle = if path >> depth & 1 == 0 { a } else { b };
            }
            prop_assert!(!triangle.divisible() || triangle.node().rank() > 0);
        }

        #[test]
        fn subtrees_stay_within_their_reach(index in 0u32..64, path: u64, depth in 0u32..50) {
            let mut triangle = start(false, index);
            for k in 0..depth {
                triangle = triangle.halves()[(path >> k & 1) as usize];
            }
            let top = triangle.node();
            let mut most = [0f64; 2];
            for k in depth..56 {
                triangle = triangle.halves()[(path >> k & 1) as usize];
                for [s, t] in triangle.corners() {
                    let (x, y) = (s.wrapping_sub(top.s) as i32, t.wrapping_sub(top.t) as i32);
                    most[0] = most[0].max(f64::from(x).hypot(f64::from(y)));
                    most[1] = most[1].max(f64::from(x.abs().max(y.abs())));
                }
            }
            prop_assert!(most[0] <= f64::from(top.subtree_radius()));
            prop_assert!(most[1] <= f64::from(top.subtree_half_width()));
        }
    }
}
