//! The codes themselves: against S_0 point by point, against each other, against a full file's.

use proptest::prelude::*;
use relief_formats::derive::decode_deviation;

use super::*;

/// Whether a node new at its level is a centre; none for one that is not new.
fn new_node(x: u32, y: u32) -> Option<bool> {
    ((x | y) & 1 == 1).then_some(x & y & 1 == 1)
}

/// S_0 at a point in level-0 cells, steps.
fn surface(x: f64, y: f64) -> f64 {
    let (i, j) = (x.floor(), y.floor().min(2047.0));
    let (u, v, i, j) = (x - i, y - j, i.rem_euclid(4096.0) as u32, j as u32);
    let h = |dx, dy| f64::from(sample::node(i + dx, j + dy));
    (1.0 - v) * ((1.0 - u) * h(0, 0) + u * h(1, 0)) + v * ((1.0 - u) * h(0, 1) + u * h(1, 1))
}

/// The largest distance found between S_0 and the two triangles about a node, steps.
fn deviation(level: u32, x: u32, y: u32, centre: bool) -> f64 {
    let step = f64::from(1u32 << level);
    // Ends of the hypotenuse, then the apex, in steps from the node.
    let hypotenuse = match centre {
        true if (x / 2 + y / 2).is_multiple_of(2) => [1.0, 1.0],
        true => [1.0, -1.0],
        false if x & 1 == 1 => [1.0, 0.0],
        false => [0.0, 1.0],
    };
    let apex = [-hypotenuse[1], hypotenuse[0]];
    let node = [f64::from(x) * step, f64::from(y) * step];
    let mut most = 0f64;
    for sign in [-1.0, 1.0] {
        let corners = [hypotenuse, hypotenuse.map(|v| -v), apex.map(|v| sign * v)]
            .map(|[dx, dy]| [node[0] + dx * step, node[1] + dy * step]);
        if corners.iter().any(|&[_, y]| !(0.0..=2048.0).contains(&y)) {
            continue;
        }
        let heights = corners.map(|[x, y]| surface(x, y));
        let n = 16;
        for (a, b) in (0..=n).flat_map(|a| (0..=n - a).map(move |b| (a, b))) {
            let w = [a, b, n - a - b].map(|k| f64::from(k) / f64::from(n));
            let sum = |f: &dyn Fn(usize) -> f64| (0..3).map(|k| w[k] * f(k)).sum::<f64>();
            let (x, y) = (sum(&|k| corners[k][0]), sum(&|k| corners[k][1]));
            most = most.max((surface(x, y) - sum(&|k| heights[k])).abs());
        }
    }
    most
}

struct World {
    sparse: Lacking,
    full: Arc<Planet>,
}

fn world() -> World {
    World { sparse: Lacking::new(sample::planet(sample::absent)), full: sample::planet(|_| false) }
}

/// The code of a node as a kernel finds it: in the tile east and north of it.
fn code(lacking: &Lacking, level: u32, x: u32, y: u32) -> u8 {
    let grid = lacking.planet.grid();
    let x = x % grid.width(level);
    let tile = TileKey::new(level, x / 256, (y / 256).min(grid.tiles_y(level) - 1));
    lacking.codes(tile).unwrap()[((y - tile.y * 256) * 257 + x % 256) as usize]
}

thread_local!(static WORLD: World = world());

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn they_bound_what_they_stand_for_and_their_children(
        level in 0u32..3, pick: (u32, u32), near: bool, beyond in -3i32..4,
    ) {
        WORLD.with(|world| {
            let grid = world.full.grid();
            let (width, height) = (grid.width(level), grid.height(level));
            let (mut x, mut y) = (pick.0 % width, pick.1 % (height + 1));
            if near {
                // A few nodes from a tile's side.
                x = (x / 256 * 256).wrapping_add_signed(beyond).wrapping_add(width) % width;
                if pick.0 % 3 == 0 {
                    y = (y / 256 * 256).saturating_add_signed(beyond).min(height);
                }
            }
            let Some(centre) = new_node(x, y) else { return Ok(()) };
            let own = code(&world.sparse, level, x, y);
            let found = deviation(level, x, y, centre);
            prop_assert!(found <= f64::from(decode_deviation(own)) + 1e-6, "{level} {x} {y}: {found} over {own}");
            let children: Vec<(u32, i64, i64)> = match centre {
                true => [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|(dx, dy)| (level, x as i64 + dx, y as i64 + dy)).into(),
                false if level > 0 => [(1, 1), (1, -1), (-1, 1), (-1, -1)]
                    .map(|(dx, dy)| (level - 1, 2 * x as i64 + dx, 2 * y as i64 + dy))
                    .into(),
                false => Vec::new(),
            };
            for (level, x, y) in children {
                let (w, h) = (i64::from(grid.width(level)), i64::from(grid.height(level)));
                if (0..=h).contains(&y) {
                    let child = code(&world.sparse, level, x.rem_euclid(w) as u32, y as u32);
                    prop_assert!(own >= child, "{own} of {x} {y} under {child}");
                }
            }
            Ok(())
        })?;
    }
}

#[test]
fn they_are_as_small_as_a_full_files_but_for_a_code_or_two() {
    let world = world();
    let (mut nodes, mut excess, mut flat) = (0u64, 0i64, 0u64);
    for key in [TileKey::new(0, 14, 5), TileKey::new(0, 3, 3), TileKey::new(1, 6, 2), TileKey::new(2, 3, 1)] {
        let (made, exact) = (world.sparse.codes(key).unwrap(), world.full.tiles().deviations(key).unwrap().unwrap());
        for (&made, &exact) in made.iter().zip(&exact) {
            nodes += u64::from(exact > 0);
            excess += i64::from(made) - i64::from(exact);
            flat += u64::from(exact == 0 && made > 0);
        }
        println!("{key:?}: {} codes in all over {nodes} nodes, {flat} where 0 would do", excess);
    }
    assert!(nodes > 100_000 && excess <= 2 * nodes as i64, "{excess} codes over {nodes} nodes");
}

#[test]
fn two_tiles_agree_on_what_they_share() {
    let world = world();
    let grid = world.full.grid();
    let mut compared = 0;
    for (level, x, y) in [(0, 15, 2), (0, 3, 3), (0, 5, 4), (1, 0, 1), (1, 6, 3), (2, 2, 0), (2, 3, 1)] {
        let key = TileKey::new(level, x, y);
        let own = world.sparse.codes(key).unwrap();
        let east = closure::beside(grid, key, 1, 0).unwrap();
        let theirs = world.sparse.codes(east).unwrap();
        for n in 0..257 {
            assert_eq!(own[n * 257 + 256], theirs[n * 257], "{key:?} row {n}");
            compared += usize::from(own[n * 257 + 256] > 0);
        }
        if let Some(north) = closure::beside(grid, key, 0, 1) {
            let theirs = world.sparse.codes(north).unwrap();
            assert_eq!(own[256 * 257..], theirs[..257], "{key:?}");
        }
    }
    assert!(compared > 500);
}

#[test]
fn a_flat_asks_for_nothing_and_a_slope_for_its_rounding_only() {
    let window = relief_formats::derive::Window::new(0, 0, TILE_NODES, TILE_NODES).expand(surround::BEYOND as i32);
    let of = |level, q: fn(i32, i32) -> i32| bounds::codes(&relief_formats::derive::Field::from_fn(window, q), level);
    assert!(of(5, |_, _| -77).iter().all(|&code| code == 0));
    assert!(of(0, |x, y| 3 * x - y).iter().all(|&code| code == 0));
    let slope = of(4, |x, _| x);
    assert!(slope.iter().all(|&code| decode_deviation(code) <= 2.5) && slope.iter().any(|&code| code > 0));
    // A single step of height counts as far as subtrees reach, and no further.
    let spike = of(4, |x, y| i32::from((x, y) == (128, 128)));
    let raised: Vec<usize> = (0..spike.len()).filter(|&k| spike[k] > 0).collect();
    assert!(raised.contains(&(128 * 257 + 127)) && raised.contains(&(127 * 257 + 127)));
    assert!(raised.iter().all(|k| (k % 257).abs_diff(128) <= 3 && (k / 257).abs_diff(128) <= 3));
}
