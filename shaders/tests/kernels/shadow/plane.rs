//! The sweep over a plane against the oracle, and against the caster of single rays.

use rayon::prelude::*;
use relief_shaders::shadow::shadow_exact;
use relief_shaders::shadow::sweep::{PlaneNodes, sweep_disk, sweep_mask};

use crate::shadow::compare::{Random, sun};
use crate::shadow::worlds::{dense, fractal_plane, planet, world};
use relief_shaders::oracle::World;

fn nodes(world: &World) -> PlaneNodes<'_, f32> {
    PlaneNodes {
        samples: &world.nodes_m,
        base: 0.0,
        unit_m: 1.0,
        columns: world.columns(),
        rows: world.rows(),
        spacing_m: world.spacing_m,
    }
}

/// Sweeps for every sun and compares a sample of the nodes with the oracle.
pub fn compare_sweep(world: &World, suns: &[(f64, f64)], sample: usize) {
    let (columns, shift) = (world.columns(), 31 - world.m);
    let (mut random, max_m) = (Random(5), world.max_m());
    for &(azimuth_deg, elevation_deg) in suns {
        let sun = sun(azimuth_deg, elevation_deg);
        let (mask, counts) = sweep_mask::<true, f32>(&nodes(world), sun);
        let norm = sun.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>().sqrt();
        let picks: Vec<u64> = (0..sample).map(|_| random.bits()).collect();
        let (wrong, inside) = picks
            .par_iter()
            .map(|&pick| {
                let (i, j) = (pick as usize % columns, (pick >> 32) as usize % world.rows());
                let margin = world.margin_under(
                    max_m,
                    (i as u32) << shift,
                    (j as u32) << shift,
                    sun.map(|v| f64::from(v) / norm),
                    0.0,
                );
                let dark = mask[j * columns + i] == 0;
                let wrong = !margin.is_inside() && dark != (margin.angle_rad > 0.0);
                if wrong {
                    println!("  node ({i}, {j}), sun {azimuth_deg} {elevation_deg}: dark {dark}, {margin:?}");
                }
                (u32::from(wrong), u32::from(margin.is_inside()))
            })
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        let all = mask.len() as f64;
        println!(
            "{}, azimuth {azimuth_deg}, elevation {elevation_deg}: {:.1} % dark, {inside} of {sample} inside, a ray {:.2} heights {:.2} bounds {:.2} rows",
            world.name,
            100.0 * mask.iter().filter(|&&v| v == 0).count() as f64 / all,
            counts.heights as f64 / all,
            counts.bounds as f64 / all,
            counts.steps as f64 / all,
        );
        assert_eq!(wrong, 0, "{} at {azimuth_deg} {elevation_deg}", world.name);
    }
}

/// All quarters of the compass, the axes, the diagonals, and a hair beside them.
pub const SUNS: [(f64, f64); 16] = [
    (0.0, 5.0),
    (90.0, 10.0),
    (180.0, 2.0),
    (270.0, 20.0),
    (45.0, 5.0),
    (135.0, 10.0),
    (225.0, 2.0),
    (315.0, 30.0),
    (44.999, 8.0),
    (1e-5, 8.0),
    (17.0, 0.5),
    (72.0, 60.0),
    (123.0, 3.0),
    (200.0, 0.001),
    (250.0, -0.5),
    (301.0, -10.0),
];

#[test]
fn sweeps_agree_with_the_oracle() {
    compare_sweep(&fractal_plane(9, [30.0, 30.0], 3000.0), &SUNS, 1500);
    compare_sweep(&fractal_plane(8, [20.0, 35.0], 800.0), &SUNS, 500);
    compare_sweep(&fractal_plane(8, [45.0, 10.0], 800.0), &SUNS, 500);
}

#[test]
fn spikes_checkerboards_and_flats_agree_with_the_oracle() {
    let spikes = world("spikes", 8, None, [30.0; 2], |i, j| if i % 37 == 5 && j % 41 == 7 { 9000.0 } else { 0.0 });
    compare_sweep(&spikes, &SUNS, 800);
    let board = world("checkerboard", 8, None, [30.0; 2], |i, j| ((i + j) % 2) as f64 * 40.0 - 11_000.0);
    compare_sweep(&board, &SUNS, 800);
    let flat = world("flat", 8, None, [30.0; 2], |_, _| 8_848.0);
    compare_sweep(&flat, &SUNS[..13], 300);
}

#[test]
fn a_sweep_of_the_disk_is_what_single_rays_see() {
    let world = fractal_plane(8, [30.0, 40.0], 3000.0);
    let (planet, dense) = (planet(&world), dense(&world));
    for (azimuth_deg, elevation_deg) in [(135.0, 5.0), (260.0, 20.0), (10.0, 1.0)] {
        let sun = sun(azimuth_deg, elevation_deg);
        let swept = sweep_disk(&planet, &nodes(&world), 0, || &dense, sun, 0.004_65);
        let (mut partly, mut differ) = (0, 0);
        for (k, &swept) in swept.iter().enumerate() {
            let [i, j] = [k % 256, k / 256];
            let place = [i, j].map(|v| (v as u32) << 23);
            let part = shadow_exact(&planet, &mut &dense, place, dense.row_m(j)[i], 0, sun, 0.004_65).visible;
            partly += usize::from(part > 0.0 && part < 1.0);
            // Where a limb touches the relief the two may round apart.
            differ += usize::from((part * 255.0 - f32::from(swept)).abs() > 1.0);
        }
        println!("{partly} see a part, {differ} differ");
        assert!(partly > 200 && differ == 0, "{partly} {differ}");
    }
}

#[test]
fn samples_of_sixteen_bits_and_suns_without_azimuth() {
    let world = fractal_plane(8, [30.0, 30.0], 1200.0);
    let samples: Vec<u16> = world.nodes_m.iter().map(|&m| ((m + 700.0) * 16.0) as u16).collect();
    let (unit_m, spacing_m) = (1.0 / 16.0, world.spacing_m);
    let narrow = PlaneNodes { samples: &samples, base: -700.0 * 16.0, unit_m, columns: 256, rows: 256, spacing_m };
    let sun = sun(200.0, 7.0);
    let mask = sweep_mask::<false, f32>(&nodes(&world), sun).0;
    assert!(mask.contains(&0) && sweep_mask::<false, u16>(&narrow, sun).0 == mask);
    let off = PlaneNodes { base: -701.0 * 16.0, ..narrow };
    assert!(off.samples.iter().zip(&world.nodes_m).any(|(&q, &m)| (f32::from(q) + off.base) * unit_m != m));
    let all = |value: u8, sun| sweep_mask::<false, u16>(&narrow, sun).0.iter().all(|&v| v == value);
    assert!(all(1, [0.0, 0.0, 1.0]) && all(0, [0.0, 0.0, -1.0]));
}
