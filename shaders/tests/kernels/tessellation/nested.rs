//! Activity is nested: an active node's parents are active.

use relief_shaders::leb::active::judge;
use relief_shaders::leb::{Params, Triangle, triangle};

use super::camera::Camera;
use super::page_set::Fault;
use super::planet::{Ground, TestPlanet, hash};
use super::scene::weights;
use super::views::{hard, random};
use crate::page_set::PageSet;

/// How many nodes of random descents are active though a parent is not. Half of the descents make
/// for a place on a tile's border.
pub fn orphans(planet: &TestPlanet, pages: &PageSet, camera: Camera, descents: u64, seed: u64) -> usize {
    let (view, pages) = (camera.view(planet), pages.pages());
    let params = Params::new(pages.planet, &view, 1, 1);
    let active = |t: &Triangle| t.divisible() && judge(&pages, &view, &params, &t.node(), &t.parent()).active;
    let mut found = 0;
    for n in 0..descents {
        let mut aim = [hash(n, 0, seed), hash(n, 1, seed)].map(|v| (v % (1 << 31)) as u32);
        if n % 2 == 0 {
            let axis = (n / 2 % 2) as usize;
            aim[axis] &= !((256 << (31 - planet.m)) - 1);
        }
        let [s, t] = aim.map(f64::from);
        let covers = |t: &Triangle, at: [f64; 2]| weights(t.corners(), at[0], at[1]).iter().all(|&w| w >= -1e-9);
        let mut at = (0..triangle::start_count(planet.plane))
            .map(|k| triangle::start(planet.plane, k))
            .find(|c| covers(c, [s, t]))
            .unwrap();
        let mut depth = 2;
        while at.divisible() {
            let halves = at.halves();
            let is = [active(&at), active(&halves[0]), active(&halves[1])];
            found += usize::from(!is[0] && is[1]) + usize::from(!is[0] && is[2]);
            // Past the last active node a few more levels.
            if is == [false; 3] && hash(n, depth, seed).is_multiple_of(4) {
                break;
            }
            let both = halves.each_ref().map(|half| covers(half, [s, t]));
            let pick = if both == [true; 2] { hash(n, depth, seed + 1) as usize % 2 } else { usize::from(both[1]) };
            at = halves[pick];
            depth += 1;
        }
    }
    found
}

#[test]
fn active_nodes_have_active_parents() {
    let planets = [
        TestPlanet::globe(9, 6_378_137.0, 6_356_752.3, 0.5, Ground::Wild { most: 12_000, seed: 1 }),
        TestPlanet::globe(8, 1000.0, 800.0, 0.125, Ground::Wild { most: 800, seed: 3 }),
        TestPlanet::plane(10, 30_000.0, 0.125, Ground::Wild { most: 8000, seed: 5 }),
    ];
    for planet in &planets {
        for (n, pages) in [
            PageSet::whole(planet),
            PageSet::of(planet, Fault::None, |k, x, y| {
                !hash(u64::from(x), u64::from(y), u64::from(k)).is_multiple_of(3)
            }),
        ]
        .iter()
        .enumerate()
        {
            for (what, camera) in if planet.plane { Vec::new() } else { hard(planet) } {
                assert_eq!(orphans(planet, pages, camera, 300, 5), 0, "{what}, pages {n}");
            }
            for k in 0..20 {
                assert_eq!(orphans(planet, pages, random(planet, k, 21), 300, k), 0, "random {k}, pages {n}");
            }
        }
    }
}

#[test]
fn deviations_of_single_nodes_are_noticed() {
    let planet = TestPlanet::globe(9, 6_378_137.0, 6_356_752.3, 0.5, Ground::Wild { most: 12_000, seed: 1 });
    let pages = PageSet::of(&planet, Fault::Unsaturated, |_, _, _| true);
    let found: usize = (0..20).map(|k| orphans(&planet, &pages, random(&planet, k, 21), 300, k)).sum();
    assert!(found > 0);
}
