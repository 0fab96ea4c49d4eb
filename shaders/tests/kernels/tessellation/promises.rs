//! Watertight, bounded, exact, complete: over views and planets.

use relief_formats::body::Body;
use relief_formats::file::Relief;
use relief_formats::grid::Grid;
use relief_tests::sample_file::{Sample, wavy_q};

use super::camera::Camera;
use super::checks::{bounded, position_error, watertight};
use super::file_pages::of_file;
use super::nested::orphans;
use super::page_set::Fault;
use super::planet::{Ground, TestPlanet, hash};
use super::scene::Scene;
use super::views::{hard, random};
use crate::page_set::PageSet;

fn earth(m: u32) -> TestPlanet {
    TestPlanet::globe(m, 6_378_137.0, 6_356_752.3, 0.5, Ground::Wild { most: 12_000, seed: 1 })
}

fn moon(m: u32) -> TestPlanet {
    TestPlanet::globe(m, 1_737_400.0, 1_737_400.0, 0.25, Ground::Hills { most: 40_000, seed: 2 })
}

/// Relief a fifth of the radius.
fn lump(m: u32) -> TestPlanet {
    TestPlanet::globe(m, 1000.0, 800.0, 0.125, Ground::Hills { most: 800, seed: 3 })
}

fn egg(m: u32) -> TestPlanet {
    TestPlanet::globe(m, 200_000.0, 260_000.0, 1.0, Ground::Wild { most: 3000, seed: 4 })
}

fn plain(m: u32) -> TestPlanet {
    TestPlanet::plane(m, 30_000.0, 0.125, Ground::Wild { most: 8000, seed: 5 })
}

/// All checks on one view; how many points were seen.
fn check(planet: &TestPlanet, pages: &PageSet, what: &str, camera: Camera, complete: bool) -> usize {
    let scene = Scene::new(planet, pages, camera);
    if let Err(why) = watertight(&scene) {
        panic!("{what}: {why}");
    }
    let position = position_error(&scene).unwrap_or_else(|why| panic!("{what}: {why}"));
    assert!(position < 5e-7, "{what}: a position is off by {position:e} of its distance; {camera:?}");
    let worst = bounded(&scene, 1600, 7).unwrap_or_else(|why| panic!("{what}: {why}"));
    if complete {
        assert!(worst.excess_px <= 0.0, "{what}: {worst:?} {camera:?}");
    }
    eprintln!(
        "{what}: {} triangles, {:?}, {:.2} px, {} seen, {} rays, position {position:.1e}",
        scene.mesh.triangles.len(),
        scene.mesh.stats,
        worst.largest_px,
        worst.seen,
        worst.rays
    );
    worst.seen
}

#[test]
fn hard_views() {
    let mut seen = 0;
    for (name, planet) in [("earth", earth(8)), ("moon", moon(9)), ("lump", lump(8)), ("egg", egg(8))] {
        let pages = PageSet::whole(&planet);
        for (view, camera) in hard(&planet) {
            seen += check(&planet, &pages, &format!("{name}, {view}"), camera, true);
        }
    }
    assert!(seen > 40_000, "{seen}");
}

#[test]
fn random_views() {
    let mut seen = 0;
    for (name, planet) in
        [("earth", earth(9)), ("moon", moon(8)), ("lump", lump(8)), ("egg", egg(8)), ("plain", plain(9))]
    {
        let pages = PageSet::whole(&planet);
        for n in 0..12 {
            seen += check(&planet, &pages, &format!("{name} {n}"), random(&planet, n, 11), true);
        }
    }
    assert!(seen > 30_000, "{seen}");
}

#[test]
fn missing_pages_leave_no_gaps() {
    let planet = earth(10);
    for n in 0..3 {
        let pages = PageSet::of(&planet, Fault::None, |k, x, y| {
            !hash(u64::from(x), u64::from(y), n + 100 * u64::from(k)).is_multiple_of(4)
        });
        for n in 0..4 {
            check(&planet, &pages, &format!("missing {n}"), random(&planet, n, 12), false);
        }
    }
}

/// The same promises with pages of a file: deviations and bounds as the bake derives and stores them.
#[test]
fn pages_of_a_file() {
    let (m, a_m) = (10, 20_000.0);
    let body = Body::Ellipsoid { name: "small".into(), a_m, b_m: 0.99 * a_m };
    let grid = Grid::new(m, false);
    let planet = TestPlanet::globe_of(m, a_m, 0.99 * a_m, 0.0625, |i, j| wavy_q(grid, i as u32, j as u32));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.relief");
    Sample::new(body, m).write(&path);
    let pages = of_file(&planet, &Relief::open(&path).unwrap());
    let hard = hard(&planet).into_iter().skip(3);
    for (what, camera) in hard.chain((0..4).map(|n| ("random", random(&planet, n, 13)))) {
        check(&planet, &pages, &format!("file, {what}"), camera, true);
        assert_eq!(orphans(&planet, &pages, camera, 100, 3), 0, "{what}");
    }
}
