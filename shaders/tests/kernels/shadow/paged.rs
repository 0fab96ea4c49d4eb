//! Masks over pages: equal to those over a dense level once all that was asked for is there.

use std::collections::BTreeSet;

use relief_shaders::pages::{key, unkey};
use relief_shaders::shadow::{ShadowWindow, WindowCounts, shadow_mask, shadow_mask_of};

use crate::page_set::PageSet;
use crate::shadow::compare::sun;
use crate::shadow::worlds::{dense, earth, fractal_globe, fractal_plane, moon};
use relief_shaders::oracle::World;

/// A window of a world with its sun: on a plane by azimuth and elevation, on a globe the unit
/// vector of longitude and latitude, degrees.
pub fn window(world: &World, place: [u32; 2], size: [u32; 2], sun_deg: [f64; 2], disk_rad: f32) -> ShadowWindow {
    let [x, y, z] = if world.ellipsoid.is_none() {
        sun(sun_deg[0], sun_deg[1])
    } else {
        let ((sl, cl), (sp, cp)) = (sun_deg[0].to_radians().sin_cos(), sun_deg[1].to_radians().sin_cos());
        [cp * cl, cp * sl, sp].map(|v| v as f32)
    };
    ShadowWindow {
        sun: [x, y, z, disk_rad],
        x: place[0],
        y: place[1],
        columns: size[0],
        rows: size[1],
        ..ShadowWindow::default()
    }
}

/// Windows with long shadows, on every kind of map; soft edges in one of two.
pub fn cases() -> Vec<(World, ShadowWindow)> {
    let plane = fractal_plane(9, [30.0, 30.0], 3000.0);
    let globe = fractal_globe("Earth", 9, earth(), 12_000.0);
    let sphere = fractal_globe("Moon", 9, moon(), 12_000.0);
    let low = window(&plane, [100, 50], [128, 100], [135.0, 6.0], 0.0);
    let soft = window(&plane, [300, 300], [90, 60], [290.0, 10.0], 0.004_65);
    // The terminator, the antimeridian and a pole.
    let morning = window(&globe, [980, 200], [130, 90], [100.0, 10.0], 0.0);
    let pole = window(&sphere, [0, 480], [160, 32], [30.0, 4.0], 0.004_65);
    let copy = |world: &World| World { nodes_m: world.nodes_m.clone(), ..*world };
    vec![(copy(&plane), low), (plane, soft), (globe, morning), (sphere, pole)]
}

fn dense_mask(world: &World, window: &ShadowWindow) -> (Vec<u8>, WindowCounts) {
    let (planet, dense) = (crate::shadow::worlds::planet(world), dense(world));
    let shift = 31 - world.m;
    let height_m = |s: u32, t: u32| dense.row_m((t >> shift) as usize)[(s >> shift) as usize];
    shadow_mask_of(&planet, window, || &dense, height_m)
}

#[test]
fn pages_shade_as_a_dense_level_does() {
    for (world, window) in cases() {
        let set = PageSet::of_world(&world, |_, _, _| true);
        let (mask, counts) = shadow_mask(&set.pages(), &window);
        let (expected, expected_counts) = dense_mask(&world, &window);
        let part = |value: u8| mask.iter().filter(|&&v| v == value).count();
        println!("{}: {} dark, {} lit of {}", world.name, part(0), part(255), mask.len());
        assert!(part(0) > mask.len() / 20 && part(255) > mask.len() / 20, "{}: nothing to see", world.name);
        assert_eq!(window.sun[3] > 0.0, part(0) + part(255) < mask.len(), "{}: a soft edge", world.name);
        assert_eq!(counts, expected_counts, "{}", world.name);
        assert!(mask == expected, "{}: masks differ", world.name);
    }
}

#[test]
fn what_is_lacking_is_asked_for_until_nothing_is() {
    for (world, window) in cases() {
        let root = world.m - 8;
        let mut held = BTreeSet::new();
        let mut rounds = 0;
        let mask = loop {
            let set = PageSet::of_world(&world, |level, x, y| level == root || held.contains(&key(level, x, y)));
            let (mask, _) = shadow_mask(&set.pages(), &window);
            let asked = set.take_asked();
            assert!(asked.iter().all(|&key| unkey(key).0 <= root));
            let before = held.len();
            held.extend(asked.into_iter().filter(|&key| unkey(key).0 != root));
            rounds += 1;
            if held.len() == before {
                break mask;
            }
        };
        assert!(rounds > 1 && mask == dense_mask(&world, &window).0, "{} after {rounds} rounds", world.name);
    }
}

#[test]
fn without_any_page_all_is_lit() {
    let (world, window) = cases().remove(0);
    let set = PageSet::of_world(&world, |_, _, _| false);
    let (mask, counts) = shadow_mask(&set.pages(), &window);
    assert!(mask.iter().all(|&v| v == 255));
    assert_eq!([counts.heights, counts.extremes], [0, 0]);
}
