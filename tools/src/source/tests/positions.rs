//! Where nodes are among pixels: registrations, directions, seams, poles, projections.

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

pub(super) struct Case {
    pub name: &'static str,
    crs: &'static str,
    size: (usize, usize),
    transform: [f64; 6],
    /// Largest error of cubic interpolation, metres.
    bound: f64,
    /// Nodes of level 0 at m = 10 that have data, at least.
    nodes: usize,
    pole: Option<i64>,
}

pub(super) const CASES: [Case; 6] = [
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

pub(super) fn case(case: &Case) -> Made {
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
