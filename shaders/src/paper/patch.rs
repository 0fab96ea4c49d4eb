//! Triangle patches: right isosceles triangles of the node grid, and the fan that splits them.

use bytemuck::{Pod, Zeroable};

use crate::leb::Node;
use crate::planet::Planet;

/// Level-0 cells along the legs of a patch of the start while m <= 13 (000, Algorithm 1, aligned).
const START_CELLS_LOG2: u32 = 6;
/// From this exponent on the start keeps its counts.
const LARGEST_M: u32 = 13;
/// East, north, west, south: columns and rows to go.
const TURNS: [[i32; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// A patch: its right-angled corner C, the turn r of its legs and their length L = 2^exponent
/// units. A lies L away from C by turn r, B by turn r + 1; C, A, B run counter-clockwise seen from
/// outside. Sides: 0 from C to A, 1 from A to B (the longest), 2 from B to C.
///
/// `struct Patch` of `wgsl/lib/paper_patch.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Pod, Zeroable)]
pub struct Patch {
    /// C in fixed point.
    pub s: u32,
    /// C in fixed point.
    pub t: u32,
    /// Turn in bits 0 and 1; in bits 2 to 4 whether sides 0 to 2 hang: beyond such a side lies a
    /// filler, not a patch of the same size; exponent from bit 5 on.
    pub code: u32,
}

impl Patch {
    /// A patch none of whose sides hang.
    #[must_use]
    pub fn new(s: u32, t: u32, exponent: u32, turn: u32) -> Self {
        Self { s, t, code: exponent << 5 | turn & 3 }
    }

    /// The legs' exponent.
    #[must_use]
    pub fn exponent(&self) -> u32 {
        self.code >> 5
    }

    /// Whether a side hangs.
    #[must_use]
    pub fn hangs(&self, side: u32) -> bool {
        self.code >> (2 + side) & 1 == 1
    }

    /// C, A, B in fixed point (S, T).
    #[must_use]
    pub fn corners(&self) -> [[u32; 2]; 3] {
        let exponent = self.exponent();
        [[self.s, self.t], go(self.s, self.t, exponent, self.code), go(self.s, self.t, exponent, self.code + 1)]
    }

    /// Midpoints of the sides: P of CA, O of AB, Q of BC. Only of a divisible patch.
    #[must_use]
    pub fn midpoints(&self) -> [[u32; 2]; 3] {
        let half = self.exponent() - 1;
        let p = go(self.s, self.t, half, self.code);
        [p, go(p[0], p[1], half, self.code + 1), go(self.s, self.t, half, self.code + 1)]
    }

    /// The node O at the middle of the longest side, the centre of the square the patch is half of.
    #[must_use]
    pub fn node(&self) -> Node {
        let [_, [s, t], _] = self.midpoints();
        Node { s, t, exponent: self.exponent() - 1, centre: true }
    }

    /// The patch of the same size beyond a side: the mirror image, everywhere on this grid.
    #[must_use]
    pub fn beyond(&self, side: u32) -> Self {
        let exponent = self.exponent();
        match side {
            0 => Self::new(self.s, self.t, exponent, self.code + 3),
            1 => {
                let [_, [s, t], _] = self.corners();
                let [s, t] = go(s, t, exponent, self.code + 1);
                Self::new(s, t, exponent, self.code + 2)
            }
            _ => Self::new(self.s, self.t, exponent, self.code + 1),
        }
    }

    /// True of a side along the map's edge: a pole, or a plane's border.
    #[must_use]
    pub fn on_edge(&self, plane: bool, side: u32) -> bool {
        let corners = self.corners();
        let (a, b) = (corners[side as usize], corners[(side as usize + 1) % 3]);
        let edge = |k: usize| a[k] == b[k] && (a[k] == 0 || a[k] == 1 << 31);
        edge(1) || plane && edge(0)
    }

    /// The four parts of the fan around O (000, Algorithms 4 and 5; two steps of longest-edge
    /// bisection). The halves of side k hang where `hanging` says so. Only of a divisible patch.
    #[must_use]
    pub fn parts(&self, hanging: [bool; 3]) -> [Self; 4] {
        let half = self.exponent() - 1;
        let [p, _, q] = self.midpoints();
        let [leg_a, longest, leg_b] = hanging.map(u32::from);
        let part = |[s, t]: [u32; 2], turn: u32, sides: [u32; 3]| {
            let hang = sides[0] | sides[1] << 1 | sides[2] << 2;
            Self { s, t, code: half << 5 | hang << 2 | (self.code + turn) & 3 }
        };
        [
            part(p, 0, [leg_a, longest, 0]),
            part(p, 1, [0, 0, leg_a]),
            part(q, 3, [leg_b, 0, 0]),
            part(q, 0, [0, longest, leg_b]),
        ]
    }
}

/// 2^exponent units from (s, t) by a turn, taken modulo 4.
fn go(s: u32, t: u32, exponent: u32, turn: u32) -> [u32; 2] {
    let [x, y] = TURNS[turn as usize & 3];
    [s.wrapping_add((x as u32) << exponent), t.wrapping_add((y as u32) << exponent)]
}

/// Level at which a patch's midpoints are nodes; below 0 for a patch that is half a level-0 cell.
#[must_use]
pub fn level(planet: &Planet, patch: &Patch) -> i32 {
    patch.exponent() as i32 - 32 + planet.m as i32
}

/// Exponent of the start's legs: those of the cells of the aligned patch mesh.
#[must_use]
pub fn start_exponent(planet: &Planet) -> u32 {
    31 + START_CELLS_LOG2 - planet.m.min(LARGEST_M)
}

/// How many patches there are to start with: two in each cell of the patch mesh.
#[must_use]
pub fn start_count(planet: &Planet) -> u32 {
    let rows = 31 - start_exponent(planet);
    1 << (2 * rows + 2 - planet.plane)
}

/// Patch `index` of the start: cells row by row from the south, two in each. A cell's diagonal
/// runs from south-west to north-east where its indices have an even sum.
#[must_use]
pub fn start(planet: &Planet, index: u32) -> Patch {
    let exponent = start_exponent(planet);
    let columns_log2 = 32 - exponent - planet.plane;
    let (x, y) = (index >> 1 & ((1 << columns_log2) - 1), index >> (columns_log2 + 1));
    let (second, odd) = (index & 1, (x + y) & 1);
    // Right angles at the south-east and north-west, or south-west and north-east.
    let east = second ^ odd ^ 1;
    let turn = 2 * second + 1 - odd;
    Patch::new((x + east) << exponent, (y + second) << exponent, exponent, turn)
}

#[cfg(test)]
mod tests {
    use std::collections::{HashMap, HashSet};

    use proptest::prelude::*;

    use super::*;

    fn planet(m: u32, plane: bool) -> Planet {
        Planet { m, plane: u32::from(plane), root_level: m - 8, ..Planet::default() }
    }

    /// Sides of patches by their ends, with how often they run each way.
    fn sides(patches: impl Iterator<Item = Patch>) -> HashMap<[[u32; 2]; 2], [u32; 2]> {
        let mut sides: HashMap<[[u32; 2]; 2], [u32; 2]> = HashMap::new();
        for patch in patches {
            let corners = patch.corners();
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                sides.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
            }
        }
        sides
    }

    #[test]
    fn the_start_is_the_patch_mesh() {
        use relief_formats::body::Body;
        use relief_formats::grid::Grid;
        use relief_formats::mesh::{MeshLayout, patch_mesh};
        for (m, count) in [(8, 64), (10, 1024), (13, 65536), (20, 65536)] {
            let planet = planet(m, false);
            assert_eq!(start_count(&planet), count);
            let mesh = patch_mesh(&Body::earth(), &Grid::new(m, false), MeshLayout::Aligned);
            let mut corners: Vec<_> = (0..count).flat_map(|i| start(&planet, i).corners()).collect();
            corners.sort_unstable();
            corners.dedup();
            let mut vertices: Vec<_> = mesh.vertices().map(|v| [v.s, v.t]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            assert_eq!(corners, vertices, "m = {m}");
        }
    }

    #[test]
    fn the_start_covers_the_map_once() {
        for (m, plane) in [(8, false), (11, false), (8, true), (13, true)] {
            let planet = planet(m, plane);
            let patches = (0..start_count(&planet)).map(|i| start(&planet, i));
            let area: u64 = patches.clone().map(|p| 1u64 << (2 * p.exponent() - 1)).sum();
            assert_eq!(area, if plane { 1 << 62 } else { 1 << 63 });
            for (side, ways) in sides(patches.clone()) {
                let edge = |k: usize| side[0][k] == side[1][k] && (side[0][k] == 0 || side[0][k] == 1 << 31);
                let on_edge = edge(1) || plane && edge(0);
                assert_eq!(ways[0] + ways[1], if on_edge { 1 } else { 2 }, "{side:?}");
                assert!(ways[0] < 2 && ways[1] < 2, "{side:?}");
            }
            let all: HashSet<Patch> = patches.clone().collect();
            for patch in patches {
                for side in 0..3 {
                    assert_ne!(all.contains(&patch.beyond(side)), patch.on_edge(plane, side), "{patch:?} {side}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn parts_cover_their_patch_and_know_their_neighbours(index in 0u32..64, path: u64, depth in 0u32..18) {
            let planet = planet(8, false);
            let mut patch = start(&planet, index);
            for k in 0..depth {
                patch = patch.parts([false; 3])[(path >> (2 * k) & 3) as usize];
            }
            let corners = patch.corners();
            let parts = patch.parts([true, false, true]);
            // Outer sides are the halves, each once and along the patch's way; inner ones run both ways.
            let inner = sides(parts.into_iter()).into_values().filter(|w| *w == [1, 1]).count();
            prop_assert_eq!(inner, 3);
            for part in parts {
                prop_assert_eq!(part.exponent(), patch.exponent() - 1);
                for side in 0..3u32 {
                    let of = |p: &Patch, k: u32| [p.corners()[k as usize], p.corners()[(k as usize + 1) % 3]];
                    let [from, to] = of(&part, side);
                    let outer = (0..3).find(|&k| {
                        let m = patch.midpoints()[k];
                        [from, to] == [corners[k], m] || [from, to] == [m, corners[(k + 1) % 3]]
                    });
                    prop_assert_eq!(part.hangs(side), outer == Some(0) || outer == Some(2));
                    if outer.is_none() {
                        let other = part.beyond(side);
                        prop_assert!(parts.iter().any(|p| (p.s, p.t, p.code & 3) == (other.s, other.t, other.code & 3)));
                    }
                    // The patch beyond has the same side, the other way round.
                    let other = part.beyond(side);
                    prop_assert!((0..3).any(|k| of(&other, k) == [to, from]), "{part:?} {side}");
                    let back = (0..3).any(|k| other.beyond(k) == Patch::new(part.s, part.t, part.exponent(), part.code));
                    prop_assert!(back);
                    // And it is a part of the patch beyond.
                    if let Some(k) = outer {
                        prop_assert!(patch.beyond(k as u32).parts([false; 3]).contains(&other), "{other:?}");
                    }
                }
            }
            let [_, o, _] = patch.midpoints();
            prop_assert_eq!(patch.node(), patch.beyond(1).node());
            prop_assert_eq!([patch.node().s, patch.node().t], o);
        }
    }
}
