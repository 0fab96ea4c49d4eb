//! Heights through the GPU path are those of the file.

use std::sync::Arc;
use std::time::Duration;

use relief_formats::body::Body;
use relief_formats::file::Relief;
use relief_runtime::gpu::{Atlas, Device, DeviceError, Heights};
use relief_runtime::planet::Planet;
use relief_runtime::residency::Resident;
use relief_tests::sample_file::Sample;

const LONG: Duration = Duration::from_secs(60);

fn resident(device: &Device, planet: &Arc<Planet>) -> Resident<Atlas> {
    let capacity = Atlas::capacity(device, 64 << 20).unwrap();
    let atlas = Atlas::new(device, planet, capacity).unwrap();
    Resident::new(Arc::clone(planet), capacity, atlas).unwrap()
}

/// Bilinear height of S_level from the file's integers, in f64.
fn expected_m(relief: &Relief, level: u32, s: u32, t: u32) -> f64 {
    let tiles = relief_formats::tiles::Tiles::new(relief, 0);
    let grid = relief.grid();
    let cell = f64::from(1u32 << (31 - grid.m)) * f64::from(1u32 << level);
    let (u, v) = (f64::from(s) / cell, f64::from(t) / cell);
    let (i, j) = ((u as u32).min(grid.width(level) - 1), (v as u32).min(grid.height(level) - 1));
    let (f, g) = (u - f64::from(i), v - f64::from(j));
    let samples = tiles.nodes(relief_formats::tile::TileKey::new(level, i / 256, j / 256)).unwrap();
    let q = |di: u32, dj: u32| f64::from(samples[((j % 256 + dj) * 257 + i % 256 + di) as usize]);
    let south = q(0, 0) * (1.0 - f) + q(1, 0) * f;
    let north = q(0, 1) * (1.0 - f) + q(1, 1) * f;
    (south * (1.0 - g) + north * g) * relief.step_m()
}

fn places() -> Vec<[u32; 2]> {
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        state ^ (state >> 15)
    };
    let mut places: Vec<[u32; 2]> = (0..500).map(|_| [next(), next() >> 1]).collect();
    for s in [0, 1, 1 << 31, u32::MAX] {
        for t in [0, 1, 1 << 30, (1 << 31) - 1, 1 << 31] {
            places.push([s, t]);
        }
    }
    places
}

#[test]
fn heights_are_the_files() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 10));
    let mut resident = resident(&device, &planet);
    let heights = Heights::new(&device).unwrap();
    let places = places();
    for level in [0, 2] {
        let (got, lacking) = heights.at(&mut resident, level, &places, LONG).unwrap();
        assert_eq!(lacking, 0);
        for (&[s, t], got) in places.iter().zip(got) {
            let expected = expected_m(planet.relief(), level, s, t);
            assert!((f64::from(got) - expected).abs() < 2e-4, "{got} {expected} at {s} {t}");
        }
    }
}

#[test]
fn a_lost_device_is_an_error_and_the_next_one_works() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 8));
    let heights = Heights::new(&device).unwrap();
    let mut lost = resident(&device, &planet);
    device.wgpu().destroy();
    let error = heights.at(&mut lost, 0, &[[0, 0]], LONG).unwrap_err();
    assert!(matches!(error, DeviceError::Lost(_)), "{error}");
    let Some(device) = crate::support::device() else { return };
    let (got, _) = Heights::new(&device).unwrap().at(&mut resident(&device, &planet), 0, &[[0, 0]], LONG).unwrap();
    assert_eq!(got, [-2835.0 / 16.0]);
}
