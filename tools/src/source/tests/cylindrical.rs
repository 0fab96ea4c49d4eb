//! Projections whose columns are meridians and whose rows are parallels: found, and sampled as
//! the general way would.

use super::consistency::{check_consistency, hard_windows};
use super::positions::{field_in, sine};
use super::*;
use crate::resample::cylindrical::Rows;
use crate::resample::projection::{Projection, geographic_part};

const MOON_M: f64 = 1_737_400.0;
const EARTH_M: f64 = 6_371_000.0;

struct Case {
    crs: String,
    size: (usize, usize),
    /// Column and row of the first pixel's corner and the sides of a pixel, metres.
    transform: [f64; 6],
    even: bool,
    /// Columns go all round.
    global: bool,
}

/// A whole sphere in Equidistant Cylindrical, `nx` columns from `west_deg` east of the central
/// meridian on.
fn plate(radius_m: f64, (lat_ts, lon_0): (f64, f64), nx: usize, west_deg: f64) -> Case {
    let dx = 2.0 * std::f64::consts::PI * radius_m * lat_ts.to_radians().cos() / nx as f64;
    let dy = 2.0 * std::f64::consts::PI * radius_m / nx as f64;
    Case {
        crs: format!("+proj=eqc +lat_ts={lat_ts} +lon_0={lon_0} +R={radius_m} +units=m +no_defs"),
        size: (nx, nx / 2),
        transform: [west_deg / 360.0 * nx as f64 * dx, dx, 0.0, 0.25 * nx as f64 * dy, 0.0, -dy],
        even: true,
        global: true,
    }
}

/// The same projection over a part of the sphere, pixels of `step_deg` on the standard parallel.
fn part(lat_ts: f64, lon_0: f64, [west, north]: [f64; 2], step_deg: f64) -> Case {
    let m = (EARTH_M * step_deg).to_radians();
    let x_m = EARTH_M * lat_ts.to_radians().cos() * (west - lon_0).to_radians();
    Case {
        crs: format!("+proj=eqc +lat_ts={lat_ts} +lon_0={lon_0} +R={EARTH_M} +units=m +no_defs"),
        size: (90, 80),
        transform: [x_m, m, 0.0, EARTH_M * north.to_radians(), 0.0, -m],
        even: true,
        global: false,
    }
}

fn cases() -> Vec<Case> {
    let mercator_m = 2.0 * 20_037_508.342_789_244;
    let mercator = |crs: &str, west_m: f64| Case {
        crs: crs.into(),
        size: (600, 600),
        transform: [west_m, mercator_m / 600.0, 0.0, 0.5 * mercator_m, 0.0, -mercator_m / 600.0],
        even: false,
        global: true,
    };
    let equal_area_m = 2.0 * std::f64::consts::PI * EARTH_M;
    vec![
        plate(MOON_M, (0.0, 180.0), 720, -180.0),
        plate(MOON_M, (0.0, 0.0), 720, -180.0),
        // Columns from 0 to 360: half of them lie east of what the projection itself gives.
        plate(MOON_M, (0.0, 0.0), 720, 0.0),
        plate(MOON_M, (35.0, -100.0), 720, -180.0),
        plate(EARTH_M, (60.0, 33.3), 720, -180.0),
        part(45.0, 10.0, [-20.0, 50.0], 0.3),
        part(0.0, 170.0, [165.0, 10.0], 0.4),
        mercator("EPSG:3857", -0.5 * mercator_m),
        mercator("EPSG:3857", 0.0),
        mercator("EPSG:3395", -0.5 * mercator_m),
        mercator("+proj=merc +lon_0=150 +datum=WGS84 +units=m +no_defs", -0.5 * mercator_m),
        Case {
            crs: format!("+proj=cea +R={EARTH_M} +units=m +no_defs"),
            size: (600, 300),
            transform: [-0.5 * equal_area_m, equal_area_m / 600.0, 0.0, EARTH_M, 0.0, -EARTH_M / 150.0],
            even: false,
            global: true,
        },
    ]
}

fn file(case: &Case) -> Made {
    let crs = SpatialRef::from_definition(&case.crs).unwrap().to_wkt().unwrap();
    let tif = Tif { size: case.size, transform: Some(case.transform), crs: Some(crs.leak()), ..Tif::default() };
    made(&tif, field_in(&case.crs, case.transform))
}

/// The same source by the general way.
fn bent(file: &Made, case: &Case, options: &SourceOptions) -> SourceSet {
    let mut set = open(&file.path, options);
    let crs = SpatialRef::from_definition(&case.crs).unwrap().to_wkt().unwrap();
    let nodes = if set.body == Body::earth() { "EPSG:4326".to_owned() } else { geographic_part(&crs).unwrap() };
    let projection = Projection::new(&file.path, case.size, &case.transform, Some((nodes, crs)), false).unwrap();
    set.sources[0].mapping = Mapping::Projected(Box::new(projection));
    set
}

/// Largest difference from the general way over nodes whose taps lie within the raster; how many
/// they are; the largest from the field itself, nodes at the seam included.
fn compare(straight: &SourceSet, bent: &SourceSet, case: &Case) -> (f64, usize, f64) {
    let grid = Grid::new(8, false);
    let (a, b) = (level(straight, &grid, 0), level(bent, &grid, 0));
    let Mapping::Projected(projection) = &bent.sources[0].mapping else { panic!("not the general way") };
    let transformer = projection.transformer().unwrap();
    let (nx, ny) = (case.size.0 as f64, case.size.1 as f64);
    let (mut worst, mut count, mut off): (f64, usize, f64) = (0.0, 0, 0.0);
    for at in (0..a.height_m.len()).step_by(3) {
        let (lon, lat) = (grid.lon_deg(0, at as i64 % 512), grid.lat_deg(0, at as i64 / 512));
        if lat.abs() >= 90.0 {
            continue;
        }
        let inside = transformer.pixel(lon, lat).is_some_and(|[c, r]| {
            let deep = |u: f64, n: f64| u > 6.0 && u < n - 6.0;
            deep(c, nx) && deep(r, ny)
        });
        if inside {
            assert_eq!((a.state[at], b.state[at]), (DATA, DATA), "{} at {lon} {lat}", case.crs);
            worst = worst.max(f64::from(a.height_m[at] - b.height_m[at]).abs());
            count += 1;
        }
        // The seam is crossed, where the general way has voids and repeats the outermost columns.
        let held = inside || (case.global && lat.abs() < 75.0);
        assert!(!held || a.state[at] == DATA, "{} at {lon} {lat}", case.crs);
        if held {
            off = off.max((f64::from(a.height_m[at]) - sine(lon, lat)).abs());
        }
    }
    (worst, count, off)
}

#[test]
fn columns_and_rows_give_what_the_general_way_gives() {
    for case in cases() {
        let file = file(&case);
        for resample in [Resample::Cubic, Resample::Average] {
            let options = SourceOptions { resample, ..given() };
            let straight = open(&file.path, &options);
            let Mapping::LonLat { rows, .. } = &straight.sources[0].mapping else { panic!("bent: {}", case.crs) };
            assert_eq!(matches!(rows, Rows::Even(_)), case.even, "{}", case.crs);
            let (worst_m, count, off_m) = compare(&straight, &bent(&file, &case, &options), &case);
            // Heights are f32 and up to 1300 m: two units in the last place.
            assert!(worst_m < 2.5e-4 && count > 150, "{} {resample:?}: {worst_m} m over {count}", case.crs);
            // A mean is not the field in its middle.
            assert!(off_m < 0.05 || resample == Resample::Average, "{} {resample:?}: {off_m} m", case.crs);
        }
    }
}

#[test]
fn heights_depend_on_the_place_alone() {
    for case in cases() {
        let file = file(&case);
        for (resample, m) in [(Resample::Auto, 8), (Resample::Auto, 12)] {
            let grid = Grid::new(m, false);
            let set = open(&file.path, &SourceOptions { resample, ..given() });
            for level in [0, 2] {
                check_consistency(&set, &grid, &hard_windows(&grid, level, 5.0, 40.0));
            }
        }
    }
}

#[test]
fn a_near_miss_stays_bent() {
    // The datum turned about an equatorial axis by so many seconds: a hundredth of a pixel of 0.5
    // degrees is 18, and a millionth 0.0018.
    let turned = |seconds: f64| {
        let plate = plate(EARTH_M, (0.0, 0.0), 720, -180.0);
        let datum = format!("+a=6378137 +b=6378137 +towgs84=0,0,0,{seconds},0,0,0");
        let scale = 6_378_137.0 / EARTH_M;
        Case {
            crs: plate.crs.replace(&format!("+R={EARTH_M}"), &datum),
            transform: plate.transform.map(|value| value * scale),
            ..plate
        }
    };
    let is_straight = |case: &Case| {
        let set = open(&file(case).path, &given());
        matches!(set.sources[0].mapping, Mapping::LonLat { .. })
    };
    assert!(is_straight(&turned(0.0)));
    assert!(!is_straight(&turned(18.0)));
    assert!(!is_straight(&turned(0.02)));
    // Nor is a raster turned by a hundredth of a pixel from side to side.
    let mut sheared = turned(0.0);
    sheared.transform[2] = 0.01 * sheared.transform[1] / sheared.size.1 as f64;
    assert!(!is_straight(&sheared));
}
