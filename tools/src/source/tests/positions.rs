//! Where nodes are among pixels: registrations, directions, seams, poles, projections.

use proptest::prelude::*;

use super::*;
use crate::resample::projection::geographic_part;
use crate::source::crs::traditional;

/// Smooth on the whole sphere, poles included.
pub(super) fn sine(lon_deg: f64, lat_deg: f64) -> f64 {
    1000.0 * lat_deg.to_radians().cos().powi(2) * (2.0 * lon_deg).to_radians().cos()
        + 300.0 * lat_deg.to_radians().sin()
}

/// Cell-registered and gridline, north-up and south-up, -180..180 and 0..360 all hold the same
/// field; the nodes must not see the difference beyond interpolation error.
#[test]
fn registrations_and_directions_agree_with_the_field() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Grid::new(8, false);
    let layouts: [(&str, (usize, usize), [f64; 6]); 5] = [
        ("cell", (720, 360), [-180.0, 0.5, 0.0, 90.0, 0.0, -0.5]),
        ("south_up", (720, 360), [-180.0, 0.5, 0.0, -90.0, 0.0, 0.5]),
        ("from_zero", (720, 360), [0.0, 0.5, 0.0, 90.0, 0.0, -0.5]),
        ("gridline", (721, 361), [-0.25, 0.5, 0.0, 90.25, 0.0, -0.5]),
        ("westwards", (720, 360), [180.0, -0.5, 0.0, 90.0, 0.0, -0.5]),
    ];
    for (name, size, transform) in layouts {
        let tif = Tif { size, transform: Some(transform), ..Tif::default() };
        let path = tif.write(folder.path(), &format!("{name}.tif"), |c, r| {
            let lon = transform[0] + (c as f64 + 0.5) * transform[1];
            let lat = transform[3] + (r as f64 + 0.5) * transform[5];
            sine(lon, lat) as f32
        });
        for (resample, bound) in [(Resample::Bilinear, 0.06), (Resample::Cubic, 0.002), (Resample::Lanczos, 0.6)] {
            let set = open(&path, &SourceOptions { resample, ..given() });
            let block = level(&set, &grid, 0);
            let mut worst: f64 = 0.0;
            for (at, height) in block.height_m.iter().enumerate() {
                let (i, j) = ((at % 512) as i64, (at / 512) as i64);
                let lat = grid.lat_deg(0, j);
                let error = f64::from(*height) - sine(grid.lon_deg(0, i), lat);
                // A pole is the mean of its row; cells have theirs a quarter degree off it.
                if lat.abs() < 90.0 {
                    worst = worst.max(error.abs());
                }
            }
            assert!(block.state.iter().all(|state| *state == DATA));
            assert!(worst < bound, "{name} {resample:?}: {worst}");
            let pole = &block.height_m[256 * 512..];
            assert!(pole.iter().all(|height| height.to_bits() == pole[0].to_bits()));
            assert!((pole[0] - 300.0).abs() < 0.01, "{name}: {}", pole[0]);
        }
    }
}

/// Heights of a field at the pixels of a raster in any CRS, through PROJ.
pub(super) fn field_in(crs: &str, transform: [f64; 6]) -> impl Fn(usize, usize) -> f32 {
    let nodes = traditional(&geographic_part(crs).unwrap()).unwrap();
    let change = gdal::spatial_ref::CoordTransform::new(&traditional(crs).unwrap(), &nodes).unwrap();
    move |c, r| {
        let (c, r) = (c as f64 + 0.5, r as f64 + 0.5);
        let mut x = [transform[0] + c * transform[1] + r * transform[2]];
        let mut y = [transform[3] + c * transform[4] + r * transform[5]];
        change.transform_coords(&mut x, &mut y, &mut []).unwrap();
        sine(x[0], y[0]) as f32
    }
}

/// Whether a place lies at least two pixels inside a raster.
fn inner(case: &Case) -> impl Fn(f64, f64) -> bool {
    let nodes = traditional("EPSG:4326").unwrap();
    let change = gdal::spatial_ref::CoordTransform::new(&nodes, &traditional(case.crs).unwrap()).unwrap();
    let (t, size) = (case.transform, case.size);
    move |lon, lat| {
        let (mut x, mut y) = ([lon], [lat]);
        if change.transform_coords(&mut x, &mut y, &mut []).is_err() {
            return false;
        }
        let (x, y, determinant) = (x[0] - t[0], y[0] - t[3], t[1] * t[5] - t[2] * t[4]);
        let (c, r) = ((t[5] * x - t[2] * y) / determinant, (t[1] * y - t[4] * x) / determinant);
        c > 2.0 && r > 2.0 && c < size.0 as f64 - 2.0 && r < size.1 as f64 - 2.0
    }
}

struct Case {
    name: &'static str,
    crs: &'static str,
    size: (usize, usize),
    transform: [f64; 6],
    /// Largest error of cubic interpolation, metres.
    bound: f64,
    /// Nodes of level 0 at m = 10 that have data, at least.
    nodes: usize,
    pole: Option<i64>,
}

const CASES: [Case; 6] = [
    Case {
        name: "antarctica",
        crs: "EPSG:3031",
        size: (300, 300),
        transform: [-3e6, 2e4, 0.0, 3e6, 0.0, -2e4],
        bound: 0.02,
        nodes: 200_000,
        pole: Some(0),
    },
    Case {
        name: "arctic",
        crs: "EPSG:3413",
        size: (300, 300),
        transform: [-3e6, 2e4, 0.0, 3e6, 0.0, -2e4],
        bound: 0.02,
        nodes: 200_000,
        pole: Some(1024),
    },
    Case {
        name: "utm across the antimeridian",
        crs: "EPSG:32660",
        size: (300, 200),
        transform: [500_000.0, 4000.0, 0.0, 8_000_000.0, 0.0, -4000.0],
        bound: 0.01,
        nodes: 2000,
        pole: None,
    },
    Case {
        name: "rotated degrees",
        crs: "EPSG:4326",
        size: (200, 200),
        transform: [-20.0, 0.08, 0.06, 10.0, 0.06, -0.08],
        bound: 0.01,
        nodes: 10_000,
        pole: None,
    },
    Case {
        name: "mercator",
        crs: "EPSG:3857",
        size: (1000, 1000),
        transform: [
            -20_037_508.342_789_244,
            40_075.016_685_578_49,
            0.0,
            20_037_508.342_789_244,
            0.0,
            -40_075.016_685_578_49,
        ],
        bound: 1.0,
        nodes: 1_900_000,
        pole: None,
    },
    Case {
        name: "lambert in feet",
        crs: "EPSG:2263",
        size: (300, 300),
        transform: [900_000.0, 2000.0, 0.0, 300_000.0, 0.0, -2000.0],
        bound: 0.01,
        nodes: 50,
        pole: None,
    },
];

fn case(case: &Case) -> Made {
    let tif = Tif { size: case.size, transform: Some(case.transform), crs: Some(case.crs), ..Tif::default() };
    made(&tif, field_in(case.crs, case.transform))
}

#[test]
fn projected_rasters_agree_with_the_field() {
    let grid = Grid::new(10, false);
    for described in &CASES {
        let file = case(described);
        let set = open(&file.path, &SourceOptions { resample: Resample::Cubic, ..given() });
        let block = level(&set, &grid, 0);
        let inner = inner(described);
        let (mut worst, mut count) = (0.0_f64, 0);
        for (at, height) in block.height_m.iter().enumerate().filter(|(at, _)| block.state[*at] == DATA) {
            let (i, j) = ((at % 2048) as i64, (at / 2048) as i64);
            let (lon, lat) = (grid.lon_deg(0, i), grid.lat_deg(0, j));
            count += 1;
            // Near the rim the kernel's taps repeat the outermost pixels.
            if !inner(lon, lat) {
                continue;
            }
            worst = worst.max((f64::from(*height) - sine(lon, lat)).abs());
        }
        println!("{}: {worst} m over {count} nodes", described.name);
        assert!(worst < described.bound && count > described.nodes, "{}: {worst} m, {count}", described.name);
        if let Some(row) = described.pole {
            let row = &block.height_m[row as usize * 2048..][..2048];
            assert!(row.iter().all(|height| height.to_bits() == row[0].to_bits() && height.abs() > 299.0));
        }
    }
}

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

#[test]
fn means_count_every_pixel_by_its_area() {
    // Nodes 0.703125 degrees apart, pixels a fifth of that, one of them 25 m high.
    let step = 180.0 / 256.0 / 5.0;
    let transform = [-5.0 * 180.0 / 256.0 - 0.5 * step, step, 0.0, 5.0 * 180.0 / 256.0 + 0.5 * step, 0.0, -step];
    let file = made(&Tif { size: (51, 51), transform: Some(transform), ..Tif::default() }, |c, r| {
        if (c, r) == (25, 25) { 25.0_f32 } else { 0.0 }
    });
    let set = open(&file.path, &given());
    let grid = Grid::new(8, false);
    let block = set.sample(0, &grid, &window(0, 255, 127, 3, 3)).unwrap();
    for (at, height) in block.height_m.iter().enumerate() {
        assert!((height - if at == 4 { 1.0 } else { 0.0 }).abs() < 1e-6, "{at}: {height}");
    }
    // The same through footprints: the raster turned by a hair, so that it counts as rotated.
    let turned = [transform[0], step, 1e-12, transform[3], 0.0, -step];
    let file = made(&Tif { size: (51, 51), transform: Some(turned), ..Tif::default() }, |c, r| {
        if (c, r) == (25, 25) { 25.0_f32 } else { 0.0 }
    });
    let set = open(&file.path, &given());
    let block = set.sample(0, &grid, &window(0, 255, 127, 3, 3)).unwrap();
    for (at, height) in block.height_m.iter().enumerate() {
        assert!((height - if at == 4 { 1.0 } else { 0.0 }).abs() < 1e-4, "{at}: {height}");
    }
}

#[test]
fn levels_and_map_exponents_follow_the_spacing() {
    let file = made(
        &Tif { size: (360, 180), transform: Some([-180.0, 1.0, 0.0, 90.0, 0.0, -1.0]), ..Tif::default() },
        |_, _| 1_i16,
    );
    let set = open(&file.path, &given());
    assert_eq!(set.default_m(), 8);
    assert_eq!(set.finest_level(0, &Grid::new(8, false)), 0);
    assert_eq!(set.finest_level(0, &Grid::new(12, false)), 4);
    // 512 rows whose spacing was rounded in the tenth place.
    let file = made(
        &Tif {
            size: (1024, 512),
            transform: Some([-180.0, 0.351_562_5, 0.0, 90.0, 0.0, -0.351_562_499_989_91]),
            ..Tif::default()
        },
        |_, _| 1_i16,
    );
    assert_eq!(open(&file.path, &given()).default_m(), 9);
}
