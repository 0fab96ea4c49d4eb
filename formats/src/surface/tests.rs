use proptest::prelude::*;

use super::*;
use crate::body::Body;
use crate::geodesy::{lat_deg, lon_deg};
use crate::grid::Grid;
use crate::sample_file::{Sample, wavy_q};

fn open(sample: &Sample) -> (tempfile::TempDir, Relief) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.relief");
    sample.write(&path);
    let relief = Relief::open(&path).unwrap();
    (folder, relief)
}

fn level_q(grid: Grid, level: u32, i: u32, j: u32) -> i32 {
    wavy_q(grid, i << level, j << level)
}

#[test]
fn nodes_seam_and_poles_are_exact() {
    let (_folder, relief) = open(&Sample::new(Body::earth(), 9));
    let surface = Surface::new(&relief, 1 << 24);
    let grid = relief.grid();
    let at = |level, lon, lat| {
        let place = Place::from_deg(grid, level, lon, lat).unwrap();
        surface.height_m(&place).unwrap() / relief.step_m()
    };
    for level in 0..=grid.root_level() {
        for (i, j) in [(0, 0), (0, 7), (3, 255), (255, 100), (256, 256), (511, 130), (400, 256)] {
            let (i, j) = (i % grid.width(level), j.min(grid.height(level)));
            let q = f64::from(level_q(grid, level, i, j));
            let (lon, lat) = (grid.lon_deg(level, i64::from(i)), grid.lat_deg(level, i64::from(j)));
            for turn in [-720.0, -360.0, 0.0, 360.0] {
                assert_eq!(at(level, lon + turn, lat), q, "level {level} node ({i}, {j})");
            }
        }
        for lon in [-180.0, -17.3, 0.0, 179.999, 180.0] {
            assert_eq!(at(level, lon, -90.0), f64::from(relief.header().south_pole_q));
            assert_eq!(at(level, lon, 90.0), f64::from(relief.header().north_pole_q));
        }
        assert_eq!(at(level, -180.0, 12.34), at(level, 180.0, 12.34));
        let (west, east) = (at(level, 180.0 - 1e-9, 12.34), at(level, -180.0 + 1e-9, 12.34));
        assert!((west - east).abs() < 1e-4, "{west} {east}");
    }
}

#[test]
fn fills_spread_to_the_cells_they_touch() {
    let (_folder, relief) = open(&Sample { filled: |i, j| (i, j) == (10, 20), ..Sample::new(Body::earth(), 8) });
    let surface = Surface::new(&relief, 0);
    let filled = |x: f64, y: f64| {
        let step = 180.0 / 256.0;
        let place = Place::from_deg(relief.grid(), 0, -180.0 + x * step, -90.0 + y * step).unwrap();
        surface.sample(&place).unwrap().filled
    };
    assert!(filled(9.5, 19.5) && filled(10.5, 20.5) && filled(10.0, 20.0));
    assert!(!filled(8.5, 19.5) && !filled(11.5, 20.5) && !filled(10.5, 21.5));
}

#[test]
fn a_plane_has_edges() {
    let body = Body::Plane { crs_wkt: String::new(), x0: 500.0, y0: 1e6, dx: 30.0, dy: 20.0 };
    let (_folder, relief) = open(&Sample::new(body, 8));
    let surface = Surface::new(&relief, 0);
    let at = |x, y| Place::from_xy(relief.body(), relief.grid(), 0, x, y).map(|p| surface.height_m(&p).unwrap());
    let q = |i, j| f64::from(level_q(relief.grid(), 0, i, j)) * relief.step_m();
    assert_eq!(at(500.0, 1e6).unwrap(), q(0, 0));
    assert_eq!(at(500.0 + 30.0 * 17.0, 1e6 + 20.0 * 255.0).unwrap(), q(17, 255));
    let middle = at(515.0, 1e6).unwrap();
    assert_eq!(middle, f64::midpoint(q(0, 0), q(1, 0)));
    assert!(at(500.0 + 30.0 * 256.0, 1e6 + 20.0 * 256.0).is_ok());
    for (x, y) in [(499.0, 1e6), (500.0, 0.0), (500.0 + 30.0 * 256.1, 1e6), (f64::NAN, 1e6), (600.0, f64::INFINITY)] {
        assert!(at(x, y).is_err(), "{x} {y}");
    }
}

#[test]
fn a_damaged_tile_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.relief");
    Sample::new(Body::earth(), 8).write(&path);
    let mut bytes = std::fs::read(&path).unwrap();
    let late = bytes.len() - 3000;
    bytes[late] ^= 0x55;
    std::fs::write(&path, bytes).unwrap();
    let relief = Relief::open(&path).unwrap();
    let surface = Surface::new(&relief, 0);
    let east = Place::from_deg(relief.grid(), 0, 90.0, 0.0).unwrap();
    assert!(surface.sample(&east).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn bounds_hold_and_both_angles_agree(s: u32, t in 0..=1u32 << 31, level in 0u32..=1) {
        thread_local!(static FILE: (tempfile::TempDir, Relief) = open(&Sample::new(Body::earth(), 9)));
        FILE.with(|(_, relief)| {
            let surface = Surface::new(relief, 1 << 24);
            let grid = relief.grid();
            let fixed = Place::from_fixed(grid, level, s, t).unwrap();
            let sample = surface.sample(&fixed).unwrap();
            let slack = 1e-9;
            prop_assert!(sample.bounds_m[0] - slack <= sample.height_m);
            prop_assert!(sample.height_m <= sample.bounds_m[1] + slack);
            // The definition, from the function that made the file.
            let shift = 31 - grid.m + level;
            let (i, j) = (s >> shift, (t >> shift).min(grid.height(level) - 1));
            let unit = f64::from(1u32 << shift);
            let (u, v) = ((f64::from(s) - f64::from(i) * unit) / unit, (f64::from(t) - f64::from(j) * unit) / unit);
            let q = |di, dj| f64::from(level_q(grid, level, (i + di) % grid.width(level), j + dj));
            let expected = (1.0 - v) * ((1.0 - u) * q(0, 0) + u * q(1, 0)) + v * ((1.0 - u) * q(0, 1) + u * q(1, 1));
            prop_assert!((sample.height_m - expected * relief.step_m()).abs() < 1e-8);
            let degrees = Place::from_deg(grid, level, lon_deg(s), lat_deg(t)).unwrap();
            prop_assert_eq!(degrees, fixed);
            Ok(())
        })?;
    }

    #[test]
    fn every_place_is_in_the_grid(m in 8u32..=20, pick: u32, lon in -1e4..1e4f64, lat in -90.0..=90.0f64) {
        let grid = Grid::new(m, false);
        let level = pick % (grid.root_level() + 1);
        let place = Place::from_deg(grid, level, lon, lat).unwrap();
        prop_assert!(grid.contains(place.tile));
        prop_assert!(u32::from(place.column) < TILE_CELLS && u32::from(place.row) < TILE_CELLS);
        prop_assert!((0.0..1.0).contains(&place.u) && (0.0..=1.0).contains(&place.v));
    }
}
