//! Heights are functions of the place alone: of no window, level or turn.

use proptest::prelude::*;

use super::positions::{CASES, case};
use super::*;

/// A node's height is the same bits at every level and in every window.
pub(super) fn check_consistency(set: &SourceSet, grid: &Grid, windows: &[NodeWindow]) {
    for window in windows {
        let block = set.sample(0, grid, window).unwrap();
        for j in 0..window.ny {
            for i in (j % 3..window.nx).step_by(3) {
                let at = j * window.nx + i;
                let (x, y) = (window.x0 + i as i64, window.y0 + j as i64);
                let alone = set.sample(0, grid, &NodeWindow { x0: x, y0: y, nx: 1, ny: 1, ..*window }).unwrap();
                let turned = i64::from(grid.width(window.level)) + x;
                let turned = set.sample(0, grid, &NodeWindow { x0: turned, y0: y, nx: 1, ny: 1, ..*window }).unwrap();
                assert_eq!(bits(&alone)[0], bits(&block)[at], "{x} {y} of {window:?}");
                assert_eq!(bits(&turned)[0], bits(&block)[at], "{x} {y} of {window:?}, turned");
                if window.level > 0 {
                    let finer = NodeWindow { level: window.level - 1, x0: 2 * x, y0: 2 * y, nx: 2, ny: 1 };
                    let finer = set.sample(0, grid, &finer).unwrap();
                    assert_eq!(bits(&finer)[0], bits(&block)[at], "{x} {y} of {window:?}, finer");
                }
            }
        }
    }
}

/// Windows that hold seams, poles and the middle of the case.
pub(super) fn hard_windows(grid: &Grid, level: u32, lon_deg: f64, lat_deg: f64) -> Vec<NodeWindow> {
    let (w, h) = (f64::from(grid.width(level)), i64::from(grid.height(level)));
    let (x, y) = (((lon_deg + 180.0) / 360.0 * w) as i64, ((lat_deg + 90.0) / 180.0 * h as f64) as i64);
    let y = y.clamp(0, h - 8);
    vec![
        window(level, x - 5, y, 11, 9),
        window(level, -4, y, 8, 5),
        window(level, x, 0, 5, 4),
        window(level, x, h - 3, 5, 4),
    ]
}

#[test]
fn projected_heights_depend_on_the_place_alone() {
    for (described, centre) in
        CASES.iter().zip([(30.0, -80.0), (30.0, 80.0), (178.0, 70.0), (-8.0, 8.0), (0.0, 40.0), (-74.0, 40.5)])
    {
        let file = case(described);
        for (resample, m) in [(Resample::Auto, 9), (Resample::Auto, 12), (Resample::Lanczos, 10)] {
            let grid = Grid::new(m, false);
            let set = open(&file.path, &SourceOptions { resample, ..given() });
            for level in [0, 1, 2] {
                check_consistency(&set, &grid, &hard_windows(&grid, level, centre.0, centre.1));
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn lon_lat_heights_depend_on_the_place_alone(
        west in -400.0..400.0_f64,
        north in -20.0..90.0_f64,
        step in 0.05..3.0_f64,
        size in (3..60_usize, 3..60_usize),
        kernel in 0..6_usize,
        voids in 2..40_usize,
        interpolate: bool,
        m in 8..10_u32,
    ) {
        let rows = size.1.min(((north + 90.0) / step) as usize).max(2);
        let tif = Tif { size: (size.0, rows), transform: Some([west, step, 0.0, north, 0.0, -step]), nodata: Some(-1.0), ..Tif::default() };
        prop_assume!(north - rows as f64 * step >= -90.0);
        let file = made(&tif, |c, r| if (c * 7 + r * 13) % voids == 1 { -1.0 } else { (c * 31 % 17) as f32 * 9.7 + r as f32 });
        let resample = [Resample::Auto, Resample::Nearest, Resample::Bilinear, Resample::Cubic, Resample::Lanczos, Resample::Average][kernel];
        let fill = if interpolate { Fill::Interpolate } else { Fill::None };
        let set = open(&file.path, &SourceOptions { resample, fill, ..given() });
        let grid = Grid::new(m, false);
        let (lon, lat) = (west + step * size.0 as f64 / 2.0, north - step * rows as f64 / 2.0);
        let lon = (lon + 180.0).rem_euclid(360.0) - 180.0;
        for level in [0, 1] {
            check_consistency(&set, &grid, &hard_windows(&grid, level, lon, lat));
        }
    }
}

#[test]
fn consistency_is_checked() {
    // The checker must see a kernel that follows the level: two grids stand for two levels.
    let file = made(
        &Tif { size: (720, 360), transform: Some([-180.0, 0.5, 0.0, 90.0, 0.0, -0.5]), ..Tif::default() },
        |c, r| ((c * 37 + r * 11) % 101) as f32,
    );
    let set = open(&file.path, &given());
    let (fine, coarse) = (Grid::new(10, false), Grid::new(8, false));
    let a = set.sample(0, &fine, &window(2, 100, 100, 8, 8)).unwrap();
    let b = set.sample(0, &coarse, &window(0, 100, 100, 8, 8)).unwrap();
    assert_ne!(bits(&a), bits(&b));
}

#[test]
fn covering_is_never_denied_where_there_is_data() {
    let grid = Grid::new(9, false);
    for described in &CASES {
        let file = case(described);
        let set = open(&file.path, &given());
        let (mut held, mut denied) = (0, 0);
        for y in 0..16 {
            for x in 0..32 {
                let part = window(0, x * 32, y * 32, 33, 33);
                let data = set.sample(0, &grid, &part).unwrap().state.contains(&DATA);
                let covers = set.covers(0, &grid, &part);
                assert!(covers || !data, "{} at {x} {y}", described.name);
                held += usize::from(data);
                denied += usize::from(!covers);
            }
        }
        assert!(held > 0 && (denied > 0 || held == 512), "{}: {held} {denied}", described.name);
    }
}
