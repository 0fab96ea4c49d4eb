//! Tears in a mesh of bisected triangles.

use std::collections::{HashMap, HashSet};

use relief_shaders::leb::{Corner, ReliefTriangle};

/// An edge that two triangles run along the same way, a corner with two heights, or an edge whose
/// midpoint is a corner: there the other side was bisected and this one was not.
pub fn torn(triangles: &[ReliefTriangle]) -> Option<String> {
    let mut heights: HashMap<[u32; 2], u32> = HashMap::new();
    let mut edges = HashSet::new();
    for triangle in triangles {
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (triangle[a], triangle[b])) {
            let bits = a.height_m.to_bits();
            if *heights.entry([a.s, a.t]).or_insert(bits) != bits {
                return Some(format!("{a:?} has two heights"));
            }
            if !edges.insert([a.s, a.t, b.s, b.t]) {
                return Some(format!("{a:?} to {b:?} twice"));
            }
        }
    }
    let middle = |a: &Corner, b: &Corner| {
        [
            a.s.wrapping_add_signed((b.s.wrapping_sub(a.s) as i32) / 2),
            a.t.wrapping_add_signed((b.t as i32 - a.t as i32) / 2),
        ]
    };
    let edges = triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    let mut crossed = edges.filter(|(a, b)| heights.contains_key(&middle(a, b)));
    crossed.next().map(|(a, b)| format!("{a:?} to {b:?} is bisected on one side"))
}
