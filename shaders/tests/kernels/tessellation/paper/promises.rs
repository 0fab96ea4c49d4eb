//! Watertight, exact, complete: over views and planets.

use relief_shaders::leb::{Mesh, Params};
use relief_shaders::paper::{Stats, tessellate};

use super::cover::{Errors, look};
use crate::page_set::PageSet;
use crate::tessellation::camera::Camera;
use crate::tessellation::checks::{position_error, watertight};
use crate::tessellation::page_set::Fault;
use crate::tessellation::planet::{Ground, TestPlanet, hash};
use crate::tessellation::scene::{Scene, places};
use crate::tessellation::views::{hard, random};

pub fn earth(m: u32) -> TestPlanet {
    TestPlanet::globe(m, 6_378_137.0, 6_356_752.3, 0.5, Ground::Wild { most: 12_000, seed: 1 })
}

fn moon(m: u32) -> TestPlanet {
    TestPlanet::globe(m, 1_737_400.0, 1_737_400.0, 0.25, Ground::Hills { most: 40_000, seed: 2 })
}

/// Relief a fifth of the radius.
pub fn lump(m: u32) -> TestPlanet {
    TestPlanet::globe(m, 1000.0, 800.0, 0.125, Ground::Hills { most: 800, seed: 3 })
}

pub fn plain(m: u32) -> TestPlanet {
    TestPlanet::plane(m, 30_000.0, 0.125, Ground::Wild { most: 8000, seed: 5 })
}

fn scene<'a>(planet: &'a TestPlanet, pages: &'a PageSet, camera: Camera) -> (Scene<'a>, Stats) {
    let view = camera.view(planet);
    let params = Params::new(&pages.planet, &view, 4_000_000, 2_000_000);
    let drawn = tessellate(&pages.pages(), &view, &params);
    assert!(!drawn.stats.overflow, "{camera:?} {:?}", drawn.stats);
    assert_eq!((drawn.stats.relief + drawn.stats.fillers) as usize, drawn.triangles.len());
    let mesh = Mesh { triangles: drawn.triangles, ..Mesh::default() };
    (Scene { planet, pages, camera, view, mesh }, drawn.stats)
}

/// All checks on one view. The scheme bounds no error; with all pages there, its RMS over what could
/// have been split further is within the threshold on these planets.
fn check(planet: &TestPlanet, pages: &PageSet, what: &str, camera: Camera, complete: bool) -> Errors {
    let (scene, stats) = scene(planet, pages, camera);
    if let Err(why) = watertight(&scene) {
        panic!("{what}: {why}");
    }
    let errors = look(&scene, 250, 7).unwrap_or_else(|why| panic!("{what}: {why}"));
    eprintln!(
        "{what}: {stats:?}, {} of {} rays, largest {:.2} px, RMS {:.2} px",
        errors.counted,
        errors.rays,
        errors.largest_px,
        errors.rms_px()
    );
    assert!(!complete || errors.rms_px() <= camera.pixel_error, "{what}: {errors:?}");
    errors
}

#[test]
fn hard_views() {
    for (name, planet) in [("earth", earth(8)), ("moon", moon(9)), ("lump", lump(8))] {
        let pages = PageSet::whole(&planet);
        for (view, camera) in hard(&planet) {
            let what = format!("{name}, {view}");
            check(&planet, &pages, &what, camera, true);
            let (scene, _) = scene(&planet, &pages, camera);
            let off = position_error(&scene).unwrap_or_else(|why| panic!("{what}: {why}"));
            assert!(off < 1e-6, "{what}: a position is off by {off:e} of its distance");
        }
    }
}

#[test]
fn random_views() {
    for (name, planet) in [("earth", earth(9)), ("moon", moon(8)), ("lump", lump(8)), ("plain", plain(9))] {
        let pages = PageSet::whole(&planet);
        for n in 0..12 {
            check(&planet, &pages, &format!("{name} {n}"), random(&planet, n, 11), true);
        }
    }
}

#[test]
fn missing_pages_leave_no_gaps() {
    let planet = earth(10);
    for n in 0..3 {
        let present = |k, x, y| !hash(u64::from(x), u64::from(y), n + 100 * u64::from(k)).is_multiple_of(4);
        let pages = PageSet::of(&planet, Fault::None, present);
        for n in 0..4 {
            check(&planet, &pages, &format!("missing {n}"), random(&planet, n, 12), false);
        }
    }
}

#[test]
fn checks_notice_a_lost_filler_and_a_lost_triangle() {
    let planet = earth(9);
    let pages = PageSet::whole(&planet);
    let camera = random(&planet, 2, 11);
    let (mut scene, stats) = scene(&planet, &pages, camera);
    assert!(stats.fillers > 10, "{stats:?}");
    assert!(watertight(&scene).is_ok());
    let whole = scene.mesh.triangles.clone();
    let flat = |t: &[[u32; 2]; 3]| {
        let d = |k: usize| [t[k][0].wrapping_sub(t[0][0]) as i32, t[k][1].wrapping_sub(t[0][1]) as i32].map(i64::from);
        d(1)[0] * d(2)[1] == d(1)[1] * d(2)[0]
    };
    scene.mesh.triangles.retain(|t| !flat(&places(t)));
    assert_eq!(whole.len() - scene.mesh.triangles.len(), stats.fillers as usize);
    assert!(watertight(&scene).is_err(), "without its fillers the mesh is open");
    assert!(look(&scene, 250, 7).is_ok());
    scene.mesh.triangles.truncate(scene.mesh.triangles.len() / 2);
    assert!(look(&scene, 250, 7).is_err(), "half of the mesh is missing");
}

#[test]
fn errors_are_noticed() {
    let planet = earth(9);
    let pages = PageSet::whole(&planet);
    let camera = random(&planet, 4, 11);
    let (scene, _) = scene(&planet, &pages, Camera { pixel_error: 40.0, ..camera });
    let errors = look(&scene, 250, 7).unwrap();
    assert!(errors.rms_px() > camera.pixel_error, "{errors:?}");
}
