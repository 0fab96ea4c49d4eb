//! The hard cases, each against the oracle: exact starts, exact directions.

use crate::shadow::compare::{Cast, Random, check, ray_count, sun};
use crate::shadow::worlds::{earth, fractal_globe, fractal_plane, mars, moon, real_earth, world};
use relief_formats::geodesy::Ellipsoid;
use relief_shaders::oracle::World;

/// Nodes at random in rows, with suns from a list of azimuths.
fn casts(
    world: &World,
    rows: std::ops::RangeInclusive<u32>,
    azimuths_deg: &[f64],
    elevations_deg: &[f64],
) -> Vec<Cast> {
    let mut random = Random(11);
    let shift = 31 - world.m;
    let columns = world.columns() as u64;
    let count = (ray_count() / 4 / (azimuths_deg.len() * elevations_deg.len())).max(8);
    let mut out = Vec::new();
    for &azimuth in azimuths_deg {
        for &elevation in elevations_deg {
            for _ in 0..count {
                let column = (random.bits() % columns) as u32;
                let row = rows.start() + (random.bits() % u64::from(rows.end() - rows.start() + 1)) as u32;
                out.push((column << shift, row << shift, sun(azimuth, elevation)));
            }
        }
    }
    out
}

const COMPASS: [f64; 8] = [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0];

#[test]
fn through_and_from_the_poles() {
    for world in [fractal_globe("Earth", 8, earth(), 12_000.0), fractal_globe("Moon", 9, moon(), 12_000.0)] {
        let top = world.rows() as u32;
        for (polar, towards) in [(top - 6..=top - 1, 0.0), (1..=6, 180.0)] {
            // Straight over the pole, a hair beside it, and past it.
            let beside = [towards, towards + 1e-4, towards - 0.01, towards + 0.5, towards + 3.0, towards - 20.0];
            check(&world, &casts(&world, polar.clone(), &beside, &[0.001, 0.3, 1.0, 3.0, 8.0]));
            check(&world, &casts(&world, polar, &COMPASS, &[0.5, 5.0]));
        }
        // From the poles themselves, in every meridian's terms.
        for pole in [0..=0, top..=top] {
            check(&world, &casts(&world, pole, &[0.0, 90.0, 180.0, 270.0, 33.3], &[-1.0, 0.1, 1.0, 4.0]));
        }
    }
}

#[test]
fn along_grid_lines_and_through_nodes() {
    for world in [fractal_plane(9, [30.0, 30.0], 3000.0), real_earth(moon(), 1.0)] {
        check(&world, &casts(&world, 0..=world.rows() as u32, &COMPASS, &[-2.0, 0.5, 2.0, 5.0, 15.0]));
    }
}

#[test]
fn across_the_antimeridian() {
    let world = fractal_globe("Mars", 8, mars(), 20_000.0);
    let columns = world.columns() as u32;
    let shift = 31 - world.m;
    let mut rays = casts(&world, 0..=256, &[80.0, 90.0, 100.0, 260.0, 270.0, 280.0], &[0.2, 1.0, 4.0]);
    for (k, (s, _, _)) in (0..).zip(rays.iter_mut()) {
        *s = [columns - 1, 0, 1][k % 3] << shift;
    }
    check(&world, &rays);
}

#[test]
fn the_sun_at_the_zenith_at_the_horizon_and_below() {
    let near_horizon = [0.0, 0.001, -0.001, 1e-5, -1e-5];
    for world in [fractal_globe("Earth", 8, earth(), 12_000.0), fractal_plane(8, [30.0, 30.0], 900.0)] {
        let rows = 0..=world.rows() as u32;
        check(&world, &casts(&world, rows.clone(), &[0.0, 77.0], &[90.0, 89.999, 89.0, -90.0, -60.0]));
        check(&world, &casts(&world, rows.clone(), &[17.0, 123.0, 211.0, 305.0], &near_horizon));
        check(&world, &casts(&world, rows, &[17.0, 123.0, 211.0, 305.0], &[-0.3, -1.0, -3.0, -6.0]));
    }
}

#[test]
fn spikes_checkerboards_flats_and_depths() {
    let bodies: [Option<Ellipsoid>; 2] = [earth(), None];
    let elevations = [-1.0, 0.1, 1.0, 5.0, 30.0];
    for body in bodies {
        let reliefs = [
            world("spikes", 8, body, [900.0; 2], |i, j| if i % 37 == 5 && j % 41 == 7 { 9000.0 } else { 0.0 }),
            world("checkerboard", 8, body, [90.0; 2], |i, j| ((i + j) % 2) as f64 * 40.0 - 11_000.0),
            world("flat", 8, body, [30.0; 2], |_, _| -11_000.0),
            world("one spike", 8, body, [30.0; 2], |i, j| if (i, j) == (100, 100) { 8848.0 } else { 0.0 }),
        ];
        for relief in &reliefs {
            let rows = 0..=relief.rows() as u32;
            check(relief, &casts(relief, rows, &[0.0, 45.0, 111.0, 202.5, 290.0], &elevations));
        }
    }
}

#[test]
fn relief_of_a_fifth_of_the_radius() {
    for (a_m, b_m) in [(1000.0, 1000.0), (1000.0, 850.0), (900.0, 1000.0)] {
        let world = fractal_globe("small body", 8, Some(Ellipsoid { a_m, b_m }), 250.0);
        check(
            &world,
            &casts(&world, 0..=256, &[0.0, 50.0, 130.0, 180.0, 200.0, 310.0], &[-20.0, -5.0, 1.0, 10.0, 40.0]),
        );
    }
}
