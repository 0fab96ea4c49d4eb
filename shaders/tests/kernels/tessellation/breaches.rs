//! The checks notice what they are there for.

use relief_shaders::leb::{Params, tessellate};

use super::camera::Camera;
use super::checks::{bounded, position_error, watertight};
use super::page_set::Fault;
use super::planet::{Ground, TestPlanet};
use super::scene::Scene;
use super::views::{hard, random};
use crate::page_set::PageSet;

fn planet() -> TestPlanet {
    TestPlanet::globe(8, 20_000.0, 19_000.0, 0.125, Ground::Hills { most: 8000, seed: 3 })
}

/// A view with a good part of the ground in it.
fn camera(planet: &TestPlanet) -> Camera {
    Camera { pitch_deg: -60.0, height_m: 9000.0, pixel_error: 1.0, ..random(planet, 3, 41) }
}

#[test]
fn a_hole_a_seam_and_a_t_junction() {
    let planet = planet();
    let pages = PageSet::whole(&planet);
    let camera = camera(&planet);
    let whole = || Scene::new(&planet, &pages, camera);
    watertight(&whole()).unwrap();
    // A triangle in the middle of the picture: the one nearest to its axis.
    let axes = camera.axes(&planet);
    let scene = whole();
    let off_axis = |k: usize| {
        let p = super::scene::drawn_point(&scene, &scene.mesh.triangles[k], [1.0 / 3.0; 3]);
        let [x, y, z] = camera.project(&axes, p);
        if z > 0.0 { x.hypot(y) } else { f64::INFINITY }
    };
    let middle = (0..scene.mesh.triangles.len()).min_by(|&a, &b| off_axis(a).total_cmp(&off_axis(b))).unwrap();

    let mut hole = whole();
    hole.mesh.triangles.remove(middle);
    assert!(watertight(&hole).is_err());

    let mut seam = whole();
    seam.mesh.triangles[middle][1].height_m += 0.001;
    assert!(watertight(&seam).is_err());
    assert!(position_error(&seam).is_err());

    // Halved alone: its neighbour across the hypotenuse has a vertex within an edge.
    let mut junction = whole();
    let [a, b, c] = junction.mesh.triangles[middle];
    let half = |p: u32, q: u32| p.wrapping_add((q.wrapping_sub(p) as i32 >> 1) as u32);
    let (s, t) = (half(b.s, c.s), half(b.t, c.t));
    let o =
        relief_shaders::leb::Corner { s, t, height_m: planet.height_m(f64::from(s), f64::from(t)) as f32, level: 0 };
    junction.mesh.triangles[middle] = [o, a, b];
    junction.mesh.triangles.push([o, c, a]);
    assert!(watertight(&junction).is_err());
}

#[test]
fn errors_beyond_the_bound() {
    let planet = planet();
    let whole = PageSet::whole(&planet);
    let camera = camera(&planet);
    assert!(bounded(&Scene::new(&planet, &whole, camera), 4000, 1).unwrap().excess_px <= 0.0);
    let bare = PageSet::of(&planet, Fault::Forgotten, |_, _, _| true);
    assert!(bounded(&Scene::new(&planet, &bare, camera), 4000, 1).unwrap().excess_px > 0.0);
    // A body taken for flat.
    let smooth = TestPlanet::globe_of(8, 20_000.0, 20_000.0, 0.125, |_, _| 0);
    let pages = PageSet::whole(&smooth);
    let mut scene = Scene::new(&smooth, &pages, camera);
    assert!(bounded(&scene, 4000, 1).unwrap().excess_px <= 0.0);
    let params = Params { curvature_m: 0.0, ..Params::new(&pages.planet, &scene.view, 100_000, 100_000) };
    scene.mesh = tessellate(&pages.pages(), &scene.view, &params);
    assert!(bounded(&scene, 4000, 1).map_or(true, |worst| worst.excess_px > 0.0));
}

#[test]
fn something_visible_culled() {
    let planet = planet();
    let pages = PageSet::whole(&planet);
    let camera = camera(&planet);
    let mut scene = Scene::new(&planet, &pages, camera);
    let narrow = Camera { fov_deg: 0.5 * camera.fov_deg, ..camera }.view(&planet);
    let params = Params::new(&pages.planet, &narrow, 100_000, 100_000);
    scene.mesh = tessellate(&pages.pages(), &narrow, &params);
    assert!(bounded(&scene, 4000, 1).is_err());
    // A horizon drawn too near: everything behind a body 5 % larger.
    let (_, camera) = hard(&planet).swap_remove(9);
    let mut scene = Scene::new(&planet, &pages, camera);
    bounded(&scene, 4000, 1).unwrap();
    let params = Params::new(&pages.planet, &scene.view, 100_000, 100_000);
    let near = Params { horizon_distance: 0.95 * params.horizon_distance, cone_cos: 0.9 * params.cone_cos, ..params };
    scene.mesh = tessellate(&pages.pages(), &scene.view, &near);
    assert!(bounded(&scene, 4000, 1).is_err());
}

#[test]
fn positions_that_are_off() {
    let planet = planet();
    let pages = PageSet::whole(&planet);
    let (_, camera) = hard(&planet).swap_remove(6);
    let mut scene = Scene::new(&planet, &pages, camera);
    assert!(position_error(&scene).unwrap() < 7e-7);
    scene.view.camera_h_lo_m += 1e-5;
    assert!(position_error(&scene).unwrap() > 7e-7);
}
