//! The visible part of the sun's disk against the oracle's margin.

use rayon::prelude::*;
use relief_shaders::oracle::World;
use relief_shaders::shadow::shadow_exact;

use crate::shadow::compare::{Random, ray_count, rays, sun};
use crate::shadow::worlds::{dense, earth, fractal_globe, fractal_plane, moon, planet, real_earth};

const RADIUS_RAD: f64 = 0.004_653_1;

/// Part of a disk above a horizon `angle_rad` above its centre, summed over thin slices.
fn visible(angle_rad: f64) -> f64 {
    let x = (angle_rad / RADIUS_RAD).clamp(-1.0, 1.0);
    let slices = 2000;
    let height = (1.0 - x) / f64::from(slices);
    let chord = |k: i32| (1.0 - (x + (f64::from(k) + 0.5) * height).powi(2)).max(0.0).sqrt();
    (0..slices).map(|k| 2.0 * chord(k) * height).sum::<f64>() / std::f64::consts::PI
}

/// Casts rays at the disk and returns how many saw a part of it.
fn compare_disks(world: &World, elevation_share: f64) -> usize {
    let (planet, dense, max_m) = (planet(world), dense(world), world.max_m());
    let mut random = Random(3);
    // Low suns, where an edge is often in the disk.
    let casts: Vec<_> = rays(world, ray_count())
        .into_iter()
        .map(|(s, t, _)| (s, t, sun(random.unit() * 360.0, random.unit() * elevation_share - 0.5)))
        .collect();
    let results: Vec<_> = casts
        .par_iter()
        .map(|&(s, t, sun)| {
            let height_m = world.height_m(s, t) as f32;
            let got = shadow_exact(&planet, &mut &dense, [s, t], height_m, 0, sun, RADIUS_RAD as f32).visible;
            let margin = world.margin_under(max_m, s, t, sun.map(f64::from), 1.5 * RADIUS_RAD);
            // The widest chord of the disk is 2 / pi of its radius.
            let allowed = 0.64 * margin.tolerance_rad() / RADIUS_RAD + 0.002;
            (f64::from(got), visible(margin.angle_rad), allowed, margin)
        })
        .collect();
    for (cast, (got, expected, allowed, margin)) in casts.iter().zip(&results) {
        assert!((got - expected).abs() <= *allowed, "{}: {cast:?} {got} {expected} {allowed} {margin:?}", world.name);
    }
    let part = results.iter().filter(|(_, part, _, _)| *part > 0.01 && *part < 0.99).count();
    println!("{}: {part} of {} rays see a part of the disk", world.name, casts.len());
    part
}

#[test]
fn disks_show_the_part_that_the_oracle_sees() {
    let mut parts = compare_disks(&fractal_plane(9, [30.0, 30.0], 3000.0), 20.0);
    parts += compare_disks(&fractal_globe("Earth", 9, earth(), 12_000.0), 3.0);
    parts += compare_disks(&fractal_globe("Moon", 9, moon(), 12_000.0), 8.0);
    parts += compare_disks(&real_earth(earth(), 1.0), 2.0);
    assert!(parts > 4 * ray_count() / 50, "only {parts} rays see a part of a disk");
}

#[test]
fn the_visible_part_falls_as_the_horizon_climbs() {
    assert!((visible(0.0) - 0.5).abs() < 1e-6);
    assert!(visible(-RADIUS_RAD) > 0.9999 && visible(RADIUS_RAD) < 1e-4);
}
