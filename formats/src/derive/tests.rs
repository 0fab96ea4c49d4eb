//! Whole blocks against the f64 oracle.

use super::block::{Base, Below, Block, derive_block, padding};
use super::code::{decode_deviation, encode_deviation};
use super::deviation::{Sources, centres, deviations};
use super::field::{Field, Window};
use super::local::local_deviation;
use super::oracle::{Heights, Truth, judge, noise, ratio, terrain};
use super::virtual_cells::{raise_interpolated, virtual_centres};
use proptest::prelude::*;

/// Off the origin, so that both signs and both parities of a cell's indices occur.
const CORE: Window = Window::new(-32, 64, 64, 96);

fn padded(f: impl Fn(i32, i32) -> i32) -> Heights {
    Field::from_fn(CORE.expand(padding(5)).nodes(), f)
}

fn block(heights: &Heights) -> Block {
    derive_block(Base { level: 0, nodes: heights.clone(), mip: None, below: None }, CORE, 5, None)
}

#[test]
fn bounds_hold_and_are_tight_on_terrain() {
    for (rough, seed) in [(0.35, 1), (0.5, 2), (0.65, 3), (0.9, 4)] {
        let ratios = judge(&terrain(CORE.expand(padding(5)).nodes(), rough, seed), CORE, 5);
        println!("roughness {rough}: mean of bound / truth, by level: {ratios:.3?}");
        for r in ratios {
            assert!((1.0..1.15).contains(&r), "{r} at roughness {rough}");
        }
    }
}

/// Levels 5 to 7 from the summaries of levels 0 to 4.
#[test]
fn a_second_stage_bounds_too() {
    let core = Window::new(0, -256, 256, 256);
    let wide = core.expand(8 << 5);
    let heights = terrain(wide.expand(padding(5)).nodes(), 0.5, 9);
    let first = derive_block(Base { level: 0, nodes: heights.clone(), mip: None, below: None }, wide, 5, None);
    assert_eq!(first.next.level, 5);
    let core5 = Window::new(core.x0 >> 5, core.y0 >> 5, core.nx >> 5, core.ny >> 5);
    let second = derive_block(first.next, core5, 3, None);
    let mut truth = Truth::new(&heights, 0);
    for plane in &second.levels {
        let cells = Window::new(
            core5.x0 >> (plane.level - 5),
            core5.y0 >> (plane.level - 5),
            8 >> (plane.level - 5),
            8 >> (plane.level - 5),
        );
        let r = ratio(plane.level, &plane.deviations.crop(cells.nodes()), &mut truth);
        println!("level {}: mean of bound / truth {r:.3}", plane.level);
        assert!((1.0..1.25).contains(&r), "{r}");
    }
    // All levels at once, with nodes three levels below instead of the base's, are no looser.
    let once = derive_block(Base { level: 0, nodes: heights.clone(), mip: None, below: None }, core, 8, None);
    for (two, one) in second.levels.iter().zip(&once.levels[5..]) {
        let cells = one.extremes.window().finer_cells();
        assert_eq!(two.extremes, one.extremes);
        assert_eq!(two.nodes.crop(cells.nodes()), one.nodes.crop(cells.nodes()));
        let filtered = |m: &Option<Field<i32>>| m.as_ref().map(|m| m.crop(cells.nodes()));
        assert_eq!(filtered(&two.mip), filtered(&one.mip));
        let pairs = two
            .deviations
            .crop(cells.nodes())
            .into_data()
            .into_iter()
            .zip(one.deviations.crop(cells.nodes()).into_data());
        assert!(pairs.map(|(two, one)| i32::from(two) - i32::from(one)).all(|d| d >= 0));
    }
}

#[test]
fn hard_heights_are_bounded() {
    let big = 1 << 23;
    type Shape = (&'static str, fn(i32, i32, i32) -> i32);
    let shapes: [Shape; 8] = [
        ("spike", |x, y, big| if (x, y) == (-1, 97) { big } else { 0 }),
        ("spike on a coarse node", |x, y, big| if (x, y) == (0, 96) { -big } else { 0 }),
        ("checkerboard", |x, y, big| if (x + y) % 2 == 0 { big } else { -big }),
        ("stripes", |x, _, big| if x % 2 == 0 { big } else { -big }),
        ("blocks", |x, y, big| if ((x >> 3) + (y >> 3)) & 1 == 0 { big } else { -big }),
        ("saddle", |x, y, _| x * y),
        ("noise", |x, y, big| (noise(x, y, 5) % (2 * big as u64 + 1)) as i32 - big),
        ("last bit", |x, y, _| (noise(x, y, 6) & 1) as i32),
    ];
    for (name, shape) in shapes {
        let ratios = judge(&padded(|x, y| shape(x, y, big)), CORE, 5);
        println!("{name}: {ratios:.3?}");
        assert!(ratios.iter().all(|r| (1.0..1.15).contains(r)), "{name} {ratios:?}");
    }
}

#[test]
fn planes_have_no_deviation() {
    for (a, b, c) in [(0, 0, 0), (0, 0, -(1 << 23)), (7, -3, 1), (1 << 14, 1 << 14, 0)] {
        let block = block(&padded(|x, y| a * x + b * y + c));
        for plane in &block.levels {
            assert!(plane.deviations.data().iter().all(|&code| code == 0));
        }
        let below: Below = block.next.below.unwrap();
        assert!(below.intervals.data().iter().all(|i| (i.lo, i.hi) == (0, 0)));
    }
}

/// The oracle and the comparison must be able to fail.
#[test]
#[should_panic(expected = "bound")]
fn a_code_too_low_is_caught() {
    let heights = terrain(CORE.expand(padding(5)).nodes(), 0.5, 2);
    let mut codes = block(&heights).levels[2].deviations.crop(Window::new(0, 24, 4, 4));
    for code in codes.data_mut() {
        *code = code.saturating_sub(3);
    }
    ratio(2, &codes, &mut Truth::new(&heights, 2));
}

#[test]
fn no_parent_is_below_its_children() {
    let heights = terrain(CORE.expand(padding(5)).nodes(), 0.8, 8);
    let levels = block(&heights).levels;
    for (index, plane) in levels.iter().enumerate() {
        let cells = plane.extremes.window().finer_cells();
        let code = |x: i32, y: i32| plane.deviations.at(x, y);
        for y in cells.y0..=cells.y1() {
            for x in cells.x0..=cells.x1() {
                if x & y & 1 == 1 {
                    let sides = [code(x - 1, y), code(x + 1, y), code(x, y - 1), code(x, y + 1)];
                    assert!(sides.iter().all(|&s| s <= code(x, y)), "level {index} ({x}, {y})");
                } else if (x | y) & 1 == 1 && index > 0 {
                    let finer = &levels[index - 1].deviations;
                    for (dx, dy) in [(-1, -1), (1, -1), (-1, 1), (1, 1)] {
                        assert!(finer.at(2 * x + dx, 2 * y + dy) <= code(x, y), "level {index} ({x}, {y})");
                    }
                }
            }
        }
    }
}

/// Extremes and means, each from its definition at level 0.
#[test]
fn extremes_and_means_follow_their_definitions() {
    let heights = padded(|x, y| (noise(x, y, 3) % (1 << 24)) as i32 - (1 << 23));
    let levels = block(&heights).levels;
    let mut mean = heights.clone();
    for (index, plane) in levels.iter().enumerate() {
        let cells = plane.extremes.window();
        let side = 2 << index;
        for y in cells.y0..cells.y1() {
            for x in cells.x0..cells.x1() {
                let nodes = heights.crop(Window::new(x * side, y * side, side as usize + 1, side as usize + 1));
                let found = plane.extremes.at(x, y);
                assert_eq!(Some(&found.min), nodes.data().iter().min());
                assert_eq!(Some(&found.max), nodes.data().iter().max());
            }
        }
        if let Some(mip) = &plane.mip {
            let inside = mip.window();
            assert!(inside.contains(&cells.finer_cells().nodes()));
            let next = Field::from_fn(inside, |x, y| {
                let tap = |dx: i32, dy: i32| i64::from(mean.at(2 * x + dx, 2 * y + dy)) * [1, 2, 1][(dx + 1) as usize];
                let sum: i64 = (-1..=1)
                    .map(|dy: i32| (2 - i64::from(dy.abs())) * (-1..=1).map(|dx| tap(dx, dy)).sum::<i64>())
                    .sum();
                (sum + 8).div_euclid(16) as i32
            });
            assert_eq!(*mip, next);
            mean = next;
        }
        assert_eq!(plane.mip.is_none(), index == 0);
    }
}

/// A large block and the small ones that tile it agree, so the caller may cut where he likes.
#[test]
fn blocks_do_not_show() {
    let heights = terrain(CORE.expand(padding(5)).nodes(), 0.6, 12);
    let whole = block(&heights);
    for (x, y) in [(-32, 64), (0, 64), (-32, 96), (0, 128)] {
        let core = Window::new(x, y, 32, 32);
        let nodes = heights.crop(core.expand(padding(5)).nodes());
        let part = derive_block(Base { level: 0, nodes, mip: None, below: None }, core, 5, None);
        for (small, large) in part.levels.iter().zip(&whole.levels) {
            let nodes = small.extremes.window().finer_cells().nodes();
            assert_eq!(small.deviations.crop(nodes), large.deviations.crop(nodes));
            assert_eq!(small.extremes, large.extremes.crop(small.extremes.window()));
        }
        let (small, large) = (part.next.below.unwrap(), whole.next.below.as_ref().unwrap());
        assert_eq!(small.intervals, large.intervals.crop(small.intervals.window()));
        assert_eq!(small.centres, large.centres.crop(small.centres.window()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// S_0 - S_k at 4 x 4 points of each level-0 cell.
    #[test]
    fn intervals_hold_the_surface(seed: u64, rough in 0.2f64..0.95) {
        let heights = terrain(CORE.expand(padding(5)).nodes(), rough, seed);
        let top = block(&heights).next;
        let below = top.below.unwrap();
        let (nodes, intervals) = (top.nodes, below.intervals);
        for (interval, extremes) in intervals.data().iter().zip(below.extremes.data()) {
            prop_assert_eq!((interval.min, interval.max), (extremes.min, extremes.max));
        }
        let bilinear = |f: &Heights, x: f64, y: f64| {
            let w = f.window();
            let (i, j) = ((x.floor() as i32).min(w.x1() - 2), (y.floor() as i32).min(w.y1() - 2));
            let (s, t) = (x - f64::from(i), y - f64::from(j));
            let at = |dx: i32, dy: i32| f64::from(f.at(i + dx, j + dy));
            at(0, 0) * (1.0 - s) * (1.0 - t) + at(1, 0) * s * (1.0 - t) + at(0, 1) * (1.0 - s) * t + at(1, 1) * s * t
        };
        for j in 4 * CORE.y0..4 * CORE.y1() {
            for i in 4 * CORE.x0..4 * CORE.x1() {
                let (x, y) = (f64::from(i) / 4.0, f64::from(j) / 4.0);
                let gap = bilinear(&heights, x, y) - bilinear(&nodes, x / 32.0, y / 32.0);
                let bound = intervals.at(i >> 7, j >> 7);
                prop_assert!(f64::from(bound.lo) / 16.0 <= gap + 1e-6 && gap <= f64::from(bound.hi) / 16.0 + 1e-6);
            }
        }
    }

    /// Four virtual levels show no more than two, and a side's code is the first that holds them.
    #[test]
    fn sides_of_level_0_hold_what_lies_below_and_no_more(seed: u64, bits in 1u32..25, spikes: bool) {
        let core = Window::new(-4, 4, 8, 8);
        let heights = Field::from_fn(core.expand(padding(1)).nodes(), |x, y| {
            let word = noise(x, y, seed);
            if spikes && !word.is_multiple_of(16) { 0 } else { ((word >> (64 - bits)) as i64 - (1 << (bits - 1))) as i32 }
        });
        let block = derive_block(Base { level: 0, nodes: heights.clone(), mip: None, below: None }, core, 1, None);
        let codes = &block.levels[0].deviations;
        let mut truth = Truth::new(&heights, 4);
        for y in core.y0..=core.y1() {
            for x in (core.x0..=core.x1()).filter(|x| (x + y) % 2 != 0) {
                let exact = truth.saturated((0, x, y));
                prop_assert!(f64::from(decode_deviation(codes.at(x, y))) >= exact);
                prop_assert!(codes.at(x, y) <= encode_deviation((exact + 1.0 / 16.0) as f32));
            }
        }
    }

    #[test]
    fn local_codes_are_the_codes_of_level_0(seed: u64, bits in 1u32..25, half_side in 2usize..20) {
        let side = 2 * half_side + 1;
        let window = Window::new(-2, -2, side + 4, side + 4);
        let low = 1i64 << (bits - 1);
        let nodes = Field::from_fn(window, |x, y| ((noise(x, y, seed) >> (64 - bits)) as i64 - low) as i32);
        let tile = Window::new(0, 0, side, side);
        let local = local_deviation(nodes.crop(tile).data(), side).unwrap();
        let children = virtual_centres(&nodes, tile.cells().expand(1));
        let sources = Sources { nodes: &nodes, intervals: None, children: Some(&children), span: 0, distances: None };
        let codes = deviations(&sources, Window::new(0, 0, half_side, half_side));
        let last = side - 1;
        for y in 0..side {
            for x in 0..side {
                // A side looks two cells far, a centre at its four sides.
                let near = x.min(y).min(last - x).min(last - y) < 2;
                let (here, true_code) = (local[y * side + x], codes.data()[y * side + x]);
                if near {
                    prop_assert!(here <= true_code);
                } else {
                    prop_assert_eq!(here, true_code);
                }
            }
        }
        prop_assert_eq!(centres(&codes).window(), Window::new(0, 0, half_side, half_side));
    }

    /// The rule as the specification words it, node by node.
    #[test]
    fn local_codes_follow_the_written_rule(seed: u64, bits in 1u32..25) {
        let side = 9i64;
        let low = 1i64 << (bits - 1);
        let nodes: Vec<i32> =
            (0..81).map(|i| ((noise(i, 0, seed) >> (64 - bits)) as i64 - low) as i32).collect();
        let h = |x: i64, y: i64| i64::from(nodes[(y * side + x) as usize]);
        let mut expected = vec![0i64; 81];
        for (cx, cy) in (0..4).flat_map(|y| (0..4).map(move |x| (x, y))) {
            let at = |x: i64, y: i64| h(2 * cx + x, 2 * cy + y);
            let e = if (cx + cy) % 2 == 0 { 2 * at(1, 1) - at(0, 0) - at(2, 2) } else { 2 * at(1, 1) - at(2, 0) - at(0, 2) };
            let mut centre = 8 * e.abs();
            for (a, b) in [(0, 0), (2, 0), (0, 2), (2, 2)] {
                let t = at(a, b) + at(1, 1) - at(1, b) - at(a, 1);
                for ((x, y), r) in [
                    ((1, b), 16 * at(1, b) - 8 * (at(0, b) + at(2, b))),
                    ((a, 1), 16 * at(a, 1) - 8 * (at(a, 0) + at(a, 2))),
                ] {
                    let side_value = &mut expected[((2 * cy + y) * side + 2 * cx + x) as usize];
                    *side_value = (*side_value).max(r.abs()).max(4 * t.abs());
                    centre = centre.max(r.abs());
                }
                if (a == b) == ((cx + cy) % 2 == 0) {
                    let end = if t < 0 { (8 * e).max(0) } else { (-8 * e).max(0) };
                    centre = centre.max(end + 0.max(4 * t.abs() - 3 * e.abs()).max(2 * t.abs() - e.abs()));
                }
            }
            expected[((2 * cy + 1) * side + 2 * cx + 1) as usize] = centre;
        }
        let twist = |x: i64, y: i64| match (0..8).contains(&x) && (0..8).contains(&y) {
            true => (h(x, y) + h(x + 1, y + 1) - h(x + 1, y) - h(x, y + 1)).abs(),
            false => 0,
        };
        for (x, y) in (0..9).flat_map(|y| (0..9).map(move |x| (x, y))).filter(|(x, y)| (x + y) % 2 == 1) {
            for (dx, dy) in [(-1, -1), (0, -1), (-1, 0), (0, 0)].map(|(dx, dy)| (x + dx, y + dy)) {
                let reach = (-1..=1).flat_map(|b| (-1..=1).map(move |a| (a, b)));
                let v = reach.map(|(a, b): (i64, i64)| match a.abs() + b.abs() {
                    0 => 4 * twist(dx, dy),
                    1 => twist(dx + a, dy + b),
                    _ => (twist(dx + a, dy + b) + 3) / 4,
                });
                if (0..8).contains(&dx) && (0..8).contains(&dy) {
                    let side_value = &mut expected[(y * side + x) as usize];
                    *side_value = v.fold(*side_value, i64::max);
                }
            }
        }
        let code = |v: i64| match (2 * v.min(1 << 29) - 1, v) {
            (_, 0) => 0,
            (z, _) if z < 4 => 1,
            (z, _) => {
                let e = i64::from(z.ilog2()) - 2;
                (4 * e + (z >> e) - 4 + 2) as u8
            }
        };
        let mut codes: Vec<u8> = expected.into_iter().map(code).collect();
        for (x, y) in (0..4).flat_map(|y| (0..4).map(move |x| (2 * x + 1, 2 * y + 1))) {
            let at = |x: i64, y: i64| (y * side + x) as usize;
            for i in [at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)] {
                codes[at(x, y)] = codes[at(x, y)].max(codes[i]);
            }
        }
        prop_assert_eq!(local_deviation(&nodes, 9).unwrap(), codes);
    }
}

/// Level-3 cells that level 2 on only interpolates, rounded level by level, beside cells with noise.
#[test]
fn centres_above_interpolation_hold_all_below() {
    let core = Window::new(0, 0, 48, 48);
    let rough = |x: i32, y: i32| x < 0 || y < 8;
    for (seed, bits) in [(1, 3), (2, 9), (3, 20)] {
        let noisy = |x: i32, y: i32, bits: u32| (noise(x, y, seed) >> (64 - bits)) as i32 - (1 << (bits - 1));
        let mut heights = Field::from_fn(core.expand(32).nodes(), |x, y| noisy(x, y, bits));
        for level in [2, 1, 0] {
            let up = 2 << level;
            let coarse = heights.clone();
            let between = |v: i32| (v.div_euclid(up) * up, (v + up - 1).div_euclid(up) * up);
            heights = Field::from_fn(coarse.window(), |x, y| {
                if (x | y) % (1 << level) != 0 || rough(x - 1, y - 1) {
                    return coarse.at(x, y);
                }
                let ((w, e), (s, n)) = (between(x), between(y));
                (coarse.at(w, s) + coarse.at(e, s) + coarse.at(w, n) + coarse.at(e, n) + 2) >> 2
            });
        }
        let nodes = heights.decimate().decimate().decimate();
        let cells = Window::new(-2, -2, 9, 9);
        let mut truth = Truth::new(&heights, 2);
        let known = |x: i32, y: i32| rough(8 * x, 8 * y);
        let mut exact = |x: i32, y: i32| truth.saturated((2, 2 * x + 1, 2 * y + 1));
        let mut codes = Field::from_fn(cells, |x, y| match known(x, y) {
            true => encode_deviation(exact(x, y) as f32),
            false => 0,
        });
        raise_interpolated(&mut codes, &nodes, 8 * 3, |x, y| !known(x, y));
        let mut raised = 0;
        for (x, y) in (1..6).flat_map(|y| (0..6).map(move |x| (x, y))) {
            let (bound, exact) = (f64::from(decode_deviation(codes.at(x, y))), exact(x, y));
            assert!(bound >= exact, "({x}, {y}) at {bits} bits: {bound} below {exact}");
            raised += u32::from(exact > 0.0);
        }
        assert!(raised > 12, "{raised}");
    }
}

#[test]
fn a_tile_of_another_shape_has_no_local_codes() {
    assert_eq!(local_deviation(&[0; 16], 4), None);
    assert_eq!(local_deviation(&[0; 24], 5), None);
    assert_eq!(local_deviation(&[7; 25], 5), Some(vec![0; 25]));
}
