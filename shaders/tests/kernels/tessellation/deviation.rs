//! Saturated deviations by brute force, from the map alone.

use super::planet::TestPlanet;

/// Deviations of the nodes of each level up to the start's, metres, row by row.
pub fn deviations(planet: &TestPlanet, saturated: bool) -> Vec<Vec<f64>> {
    let mut levels: Vec<Vec<f64>> = Vec::new();
    for k in 0..=planet.m - 2 - u32::from(!planet.plane) {
        let (w, h) = (planet.cells_x() >> k, planet.cells_y() >> k);
        let columns = if planet.plane { w + 1 } else { w };
        let mut level = vec![0.0; (columns * (h + 1)) as usize];
        let at = |i: i64, j: i64| (j * columns + if planet.plane { i } else { i.rem_euclid(w) }) as usize;
        let inside = |i: i64, j: i64| (0..=h).contains(&j) && (!planet.plane || (0..=w).contains(&i));
        // Sides, raised to the centres below; then centres, raised to their sides.
        for centres in [false, true] {
            for j in 0..=h {
                for i in 0..columns {
                    if i % 2 + j % 2 != 1 + i64::from(centres) {
                        continue;
                    }
                    let mut most = 0f64;
                    for [a, b, c] in triangles(i, j) {
                        if inside(a.0, a.1) && inside(b.0, b.1) && inside(c.0, c.1) {
                            most =
                                most.max(distance_q(planet, [a, b, c].map(|(x, y)| (x << k, y << k))) * planet.step_m);
                        }
                    }
                    if saturated && centres {
                        for (x, y) in [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)] {
                            most = most.max(level[at(x, y)]);
                        }
                    } else if saturated {
                        for (x, y) in [
                            (2 * i - 1, 2 * j - 1),
                            (2 * i + 1, 2 * j - 1),
                            (2 * i - 1, 2 * j + 1),
                            (2 * i + 1, 2 * j + 1),
                        ] {
                            most = most.max(centre_below(planet, &levels, k, x, y));
                        }
                    }
                    level[at(i, j)] = most;
                }
            }
        }
        levels.push(level);
    }
    levels
}

/// Saturated deviation of node (x, y) of level k - 1, a centre: stored, or inside a cell.
fn centre_below(planet: &TestPlanet, levels: &[Vec<f64>], k: u32, x: i64, y: i64) -> f64 {
    let (w, h) = (planet.cells_x() >> k, planet.cells_y() >> k);
    let (cell_x, cell_y) = (x >> 1, y >> 1);
    if !(0..h).contains(&cell_y) || planet.plane && !(0..w).contains(&cell_x) {
        return 0.0;
    }
    if k > 0 {
        let columns = if planet.plane { 2 * w + 1 } else { 2 * w };
        let x = if planet.plane { x } else { x.rem_euclid(2 * w) };
        return levels[k as usize - 1][(y * columns + x) as usize];
    }
    let mut most = 0f64;
    for dy in -1..=1i64 {
        for dx in -1..=1i64 {
            most =
                most.max(twist_m(planet, cell_x + dx, cell_y + dy) / 4f64.powi(1 + dx.abs() as i32 + dy.abs() as i32));
        }
    }
    most
}

/// |h00 - h10 - h01 + h11| of a level-0 cell, metres; 0 beyond the map.
pub fn twist_m(planet: &TestPlanet, x: i64, y: i64) -> f64 {
    if !(0..planet.cells_y()).contains(&y) || planet.plane && !(0..planet.cells_x()).contains(&x) {
        return 0.0;
    }
    let h = |i, j| f64::from(planet.node(x + i, y + j));
    (h(0, 0) - h(1, 0) - h(0, 1) + h(1, 1)).abs() * planet.step_m
}

/// The two triangles whose hypotenuse node (i, j) halves, in nodes of its level.
fn triangles(i: i64, j: i64) -> [[(i64, i64); 3]; 2] {
    let (west, east, south, north) = (i - 1, i + 1, j - 1, j + 1);
    if i & 1 == 1 && j & 1 == 1 {
        if ((i >> 1) + (j >> 1)) & 1 == 0 {
            let (a, b) = ((west, south), (east, north));
            [[a, b, (west, north)], [a, b, (east, south)]]
        } else {
            let (a, b) = ((east, south), (west, north));
            [[a, b, (west, south)], [a, b, (east, north)]]
        }
    } else if i & 1 == 1 {
        [[(west, j), (east, j), (i, south)], [(west, j), (east, j), (i, north)]]
    } else {
        [[(i, south), (i, north), (west, j)], [(i, south), (i, north), (east, j)]]
    }
}

/// The largest |S_0 - T| over a triangle of level-0 nodes, steps: at nodes, and where a slanted
/// edge cuts a cell.
fn distance_q(planet: &TestPlanet, [a, b, c]: [(i64, i64); 3]) -> f64 {
    let h = |p: (i64, i64)| f64::from(planet.node(p.0, p.1));
    let det = ((b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1)) as f64;
    let weights = |x: i64, y: i64| {
        let v = ((x - a.0) * (c.1 - a.1) - (c.0 - a.0) * (y - a.1)) as f64 / det;
        let w = ((b.0 - a.0) * (y - a.1) - (x - a.0) * (b.1 - a.1)) as f64 / det;
        (v, w)
    };
    let gap = |x: i64, y: i64| {
        let (v, w) = weights(x, y);
        h((x, y)) - (h(a) + v * (h(b) - h(a)) + w * (h(c) - h(a)))
    };
    let mut most = 0f64;
    let range = |f: fn(&(i64, i64)) -> i64| {
        let v = [f(&a), f(&b), f(&c)];
        v[0].min(v[1]).min(v[2])..=v[0].max(v[1]).max(v[2])
    };
    for y in range(|p| p.1) {
        for x in range(|p| p.0) {
            let (v, w) = weights(x, y);
            if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
                most = most.max(gap(x, y).abs());
            }
        }
    }
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let (dx, dy) = ((q.0 - p.0).signum(), (q.1 - p.1).signum());
        if dx == 0 || dy == 0 {
            continue;
        }
        for n in 0..(q.0 - p.0).abs() {
            let (x0, y0) = (p.0 + n * dx, p.1 + n * dy);
            let (r0, r1) = (gap(x0, y0), gap(x0 + dx, y0 + dy));
            // S_0 along a cell's diagonal is its chord less t x (1 - x).
            let t = h((x0, y0)) + h((x0 + dx, y0 + dy)) - h((x0 + dx, y0)) - h((x0, y0 + dy));
            if t != 0.0 {
                let x = (0.5 - (r1 - r0) / (2.0 * t)).clamp(0.0, 1.0);
                most = most.max((r0 + (r1 - r0) * x - t * x * (1.0 - x)).abs());
            }
        }
    }
    most
}
