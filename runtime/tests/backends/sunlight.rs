//! Sunlight of points: kernel and twin against the oracle, and against each other.

use std::sync::Arc;
use std::time::Duration;

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_runtime::cpu::Cpu;
use relief_runtime::gpu::{Gpu, ShadowPoints};
use relief_runtime::planet::Planet;
use relief_runtime::shadow::{PointSun, SunlitPoint, points_in_ram, sun_of};
use relief_runtime::view::{SUN_RADIUS_DEG, Sun};
use relief_shaders::oracle::World;
use relief_shaders::shadow::dense::nodes_of;
use relief_shaders::shadow::sun::sun_local;

use crate::cpu_frame::rough;
use relief_tests::sample_file::{Sample, wavy_q};

const LONG: Duration = Duration::from_secs(100);
const ATLAS_BYTES: u64 = 100 << 20;
const SPACING_M: f64 = 30.0;
const POINTS: usize = 3000;

/// Hills of some hundred metres.
fn hills(grid: Grid, i: u32, j: u32) -> i32 {
    4 * wavy_q(grid, i, j)
}

fn planets() -> [Arc<Planet>; 2] {
    let plane = Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: SPACING_M, dy: SPACING_M };
    [rough(Body::moon(), 9), Sample { q: hills, ..Sample::new(plane, 9) }].map(|sample| crate::support::planet(&sample))
}

fn world(planet: &Planet) -> World {
    let nodes_m = nodes_of(&planet.uniform(), planet.tiles(), 0).unwrap();
    World { name: "sample", m: 9, ellipsoid: planet.ellipsoid(), spacing_m: [SPACING_M; 2], nodes_m }
}

/// All over the map, half of them on nodes.
fn places(plane: bool) -> Vec<[u32; 2]> {
    let mut state = 7u64;
    let mut bits = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    };
    (0..POINTS)
        .map(|k| {
            let [s, t] = [bits() >> u32::from(plane), bits() >> 1];
            if k % 2 == 0 { [s, t] } else { [s >> 22 << 22, t >> 22 << 22] }
        })
        .collect()
}

/// What asks a backend.
type Ask<'a> = Box<dyn FnMut(&PointSun, &[[u32; 2]]) -> Vec<SunlitPoint> + 'a>;

/// The twin, and the kernel where there is an adapter.
fn backends(planet: &Arc<Planet>) -> Vec<Ask<'static>> {
    let mut cpu = Cpu::new(Arc::clone(planet), ATLAS_BYTES).unwrap();
    let mut all: Vec<Ask<'static>> = vec![Box::new(move |sun, places| {
        let answers = points_in_ram(cpu.resident_mut(), sun, places, LONG);
        assert_eq!(answers.lacking, 0);
        answers.points
    })];
    if let Some(device) = crate::support::device() {
        let mut gpu = Gpu::new(&device, Arc::clone(planet), ATLAS_BYTES).unwrap();
        let kernel = ShadowPoints::new(&device).unwrap();
        all.push(Box::new(move |sun, places| {
            let answers = kernel.at(gpu.resident_mut(), sun, places, LONG).unwrap();
            assert_eq!(answers.lacking, 0);
            answers.points
        }));
    }
    all
}

/// A low sun and a high one; over a globe both are somewhere.
fn suns(planet: &Planet) -> Vec<Sun> {
    match planet.grid().plane {
        true => [[135.0, 2.5], [290.0, 8.0], [0.0, 40.0]].map(|[azimuth, up]| Sun::at(azimuth, up).unwrap()).into(),
        false => [[20.0, 5.0], [-175.0, -60.0]].map(|[lon, lat]| Sun::over(lon, lat).unwrap()).into(),
    }
}

/// How many points see or miss the sun against the oracle's word, and how many it leaves open.
fn against_oracle(planet: &Planet, world: &World, sun: &PointSun, points: &[SunlitPoint]) -> [usize; 2] {
    let [x, y, z, _] = sun.sun;
    let max_m = world.max_m();
    let mut counts = [0, 0];
    for point in points {
        let towards = if planet.grid().plane { [x, y, z] } else { sun_local([x, y, z], 1 << 31, point.s, point.t) };
        let towards = towards.map(f64::from);
        let length = towards.iter().map(|v| v * v).sum::<f64>().sqrt();
        let margin = world.margin_under(max_m, point.s, point.t, towards.map(|v| v / length), 0.0);
        let dark = point.visible == 0.0;
        counts[0] += usize::from(!margin.is_inside() && dark != (margin.angle_rad > 0.0));
        counts[1] += usize::from(margin.is_inside());
    }
    counts
}

#[test]
fn points_see_the_sun_that_the_oracle_sees() {
    for planet in planets() {
        let (world, places) = (world(&planet), places(planet.grid().plane));
        for ask in &mut backends(&planet) {
            let mut dark = 0;
            for sun in suns(&planet) {
                let sun = PointSun { sun: sun_of(&sun, 0.0), ..PointSun::default() };
                let points = ask(&sun, &places);
                for (point, &[s, t]) in points.iter().zip(&places) {
                    assert_eq!([point.s, point.t], [s, t]);
                    assert!((f64::from(point.height_m) - world.height_m(s, t)).abs() < 2e-3, "{point:?}");
                }
                let [wrong, open] = against_oracle(&planet, &world, &sun, &points);
                assert!(wrong == 0 && open <= POINTS / 100, "{sun:?}: {wrong} wrong, {open} within the margin");
                dark += points.iter().filter(|point| point.visible == 0.0).count();
                // The oracle notices another sun.
                let moved = PointSun { sun: [-sun.sun[1], sun.sun[0], sun.sun[2], 0.0], ..sun };
                let [wrong, _] = against_oracle(&planet, &world, &moved, &points);
                assert!(wrong > POINTS / 100, "{sun:?}: {wrong}");
            }
            assert!((POINTS / 5..2 * POINTS).contains(&dark), "{dark} dark");
        }
    }
}

#[test]
fn backends_agree_on_soft_edges_and_coarse_levels() {
    for planet in planets() {
        let mut backends = backends(&planet);
        let places = places(planet.grid().plane);
        for (sun, level) in suns(&planet).into_iter().zip([0, 1, 0]) {
            let sun = PointSun { sun: sun_of(&sun, SUN_RADIUS_DEG), level, ..PointSun::default() };
            let answers: Vec<Vec<SunlitPoint>> = backends.iter_mut().map(|ask| ask(&sun, &places)).collect();
            let partly = answers[0].iter().filter(|point| ![0.0, 1.0].contains(&point.visible)).count();
            assert!(partly > 0, "{sun:?}: no edge is soft");
            for other in &answers[1..] {
                let apart = |(a, b): &(&SunlitPoint, &SunlitPoint)| {
                    (a.visible - b.visible).abs() > 0.02 || (a.height_m - b.height_m).abs() > 1e-3
                };
                let differ = answers[0].iter().zip(other).filter(apart).count();
                assert!(differ <= POINTS / 1000, "{sun:?}: {differ} points differ");
            }
        }
    }
}
