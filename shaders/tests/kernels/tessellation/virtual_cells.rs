//! Deviations below level 0 against a recursion over all nodes down to 1/32 of a cell.

use std::collections::HashMap;

use relief_shaders::leb::active::level;
use relief_shaders::leb::virtual_cells::virtual_cells;
use relief_shaders::leb::{Triangle, triangle};

use super::planet::{Ground, TestPlanet, hash};
use crate::page_set::PageSet;

/// The largest |S_0 - T| over a triangle within one cell, from its corners and along its edges.
fn need_m(planet: &TestPlanet, triangle: &Triangle) -> f64 {
    let units = planet.cell_units();
    let corners = triangle.corners();
    let at = |k: usize| {
        let s = f64::from(corners[0][0]) + f64::from(corners[k][0].wrapping_sub(corners[0][0]) as i32);
        [s / units, f64::from(corners[k][1]) / units]
    };
    let p = [at(0), at(1), at(2)];
    let h = p.map(|[x, y]| planet.surface_m(x, y));
    // S_0 - T is a quadratic along each edge, 0 at its ends: largest in the middle.
    (0..3)
        .map(|k| {
            let n = (k + 1) % 3;
            let (x, y) = (0.5 * (p[k][0] + p[n][0]), 0.5 * (p[k][1] + p[n][1]));
            (planet.surface_m(x, y) - 0.5 * (h[k] + h[n])).abs()
        })
        .fold(0.0, f64::max)
}

/// Saturated need of a node, by going down `depth` bisections; both triangles.
fn saturated(planet: &TestPlanet, t: Triangle, depth: u32, known: &mut HashMap<(u32, u32), f64>) -> f64 {
    if depth == 0 {
        return 0.0;
    }
    if let Some(&found) = known.get(&(t.s, t.t)) {
        return found;
    }
    let mut most = 0f64;
    for side in [t, Triangle { code: t.code ^ 4, ..t }] {
        let [[_, apex_t], ..] = side.corners();
        if apex_t > 1 << 31 {
            continue;
        }
        most = most.max(need_m(planet, &side));
        for half in side.halves() {
            most = most.max(saturated(planet, half, depth - 1, known));
        }
    }
    known.insert((t.s, t.t), most);
    most
}

#[test]
fn formulas_are_the_recursion() {
    let planet = TestPlanet::globe(8, 1000.0, 1000.0, 1.0, Ground::Wild { most: 800, seed: 9 });
    let set = PageSet::whole(&planet);
    let pages = set.pages();
    let (mut compared, mut at_border) = (0, 0);
    for n in 0..400 {
        let mut at = triangle::start(false, (hash(n, 0, 1) % 64) as u32);
        let stop = hash(n, 1, 1) % 9;
        let mut below = 0;
        while below <= stop {
            let halves = at.halves();
            let random = (hash(n, below + 2 * u64::from(at.code), 2) % 2) as usize;
            // One in three keeps to the southern edge.
            let pick = if n % 3 == 0 { usize::from(halves[1].t < halves[0].t) } else { random };
            at = halves[pick];
            below += u64::from(level(&pages, &at.node()) < 0);
        }
        let node = at.node();
        let got = f64::from(virtual_cells(&pages, &node).deviation_m);
        let truth = saturated(&planet, at, 8, &mut HashMap::new());
        assert!((got - truth).abs() <= 1e-5 * truth, "{node:?}: {got}, not {truth}");
        compared += 1;
        at_border += usize::from(node.t == 0 || node.t == 1 << 31);
    }
    assert!(compared == 400 && at_border > 3, "{at_border}");
}
