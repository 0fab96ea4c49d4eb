//! Masks against shadows that are known in closed form.

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_tests::folder::Folder;
use relief_tests::plane::{SPACING_M, plane};
use relief_tests::sample_file::{Sample, wavy_q};

use crate::probe::backends;
use crate::program::{png, reliefd};

/// Row of pixel y of a picture with north up, of `rows` rows.
const fn row(y: usize, rows: usize) -> usize {
    rows - 1 - y
}

/// Column of the wall, and its height in steps of 1/16 m.
const WALL: u32 = 200;
const WALL_Q: i32 = 16 * 1000;

pub fn wall(_: Grid, i: u32, _: u32) -> i32 {
    if i == WALL { WALL_Q } else { 0 }
}

/// A wall of 1000 m that runs south to north, and the sun in the east: its shadow reaches
/// 1000 m / tan(elevation) to the west.
#[test]
fn a_wall_casts_its_length() {
    let folder = Folder::new();
    let file = folder.sample("wall.relief", &plane(wall));
    for elevation_deg in [15.0f64, 30.0, 60.0] {
        for soft in ["", "--soft"] {
            reliefd(&format!("mask FILE --sun 90,{elevation_deg} {soft} -o OUT/a.png"), &file).good();
            let (width, height, _, lit) = png(&folder.path("a.png"));
            assert_eq!((width, height), (256, 256));
            let reach_cells = 1000.0 / elevation_deg.to_radians().tan() / SPACING_M;
            for (k, &lit) in lit.iter().enumerate() {
                let away = f64::from(WALL) - (k % 256) as f64;
                // The half degree of the disk, at the edge of the shadow.
                let blur =
                    if soft.is_empty() { 0.01 } else { 0.3 + 0.012 * reach_cells / elevation_deg.to_radians().sin() };
                let expected = match away {
                    away if away <= 0.0 || away > reach_cells + blur => 255,
                    away if away < reach_cells - blur => 0,
                    _ => continue,
                };
                assert_eq!(lit, expected, "{elevation_deg} {soft}: {away} cells west of the wall");
            }
            let shades = lit.iter().filter(|&&v| !matches!(v, 0 | 255)).count();
            // A high sun's edge is narrower than a cell.
            if soft.is_empty() || elevation_deg < 45.0 {
                assert_eq!(shades > 0, !soft.is_empty(), "{shades} shades at {elevation_deg}");
            }
        }
    }
}

/// The rays of the sweep and single rays agree; a slope that the oracle of the kernels measures.
#[test]
fn both_ways_over_a_plane_agree() {
    let folder = Folder::new();
    let file = folder.sample("hills.relief", &plane(wavy_q));
    reliefd("mask FILE --sun 213,4 -o OUT/a.png", &file).good();
    let (.., swept) = png(&folder.path("a.png"));
    let nodes: Vec<(usize, usize)> = (0..64).map(|k| (k * 37 % 256, k * 101 % 256)).collect();
    let points: String = nodes
        .iter()
        .map(|&(i, j)| format!("{} {}\n", 1000.0 + SPACING_M * i as f64, 2000.0 + SPACING_M * j as f64))
        .collect();
    let run = crate::program::with_input("probe FILE - --sun 213,4 --backend cpu", &file, &points).good();
    let mut both = [0, 0];
    for (line, &(i, j)) in run.stdout.lines().zip(&nodes) {
        let lit = serde_json::from_str::<serde_json::Value>(line).unwrap()["lit"].as_f64().unwrap();
        let here = swept[row(j, 256) * 256 + i];
        assert_eq!(lit * 255.0, f64::from(here), "({i}, {j})");
        both[usize::from(here > 0)] += 1;
    }
    assert!(both[0] > 5 && both[1] > 5, "{both:?}");
}

fn flat(_: Grid, _: u32, _: u32) -> i32 {
    160
}

/// A smooth sphere: day where the sun is above the horizon, night elsewhere.
#[test]
fn the_terminator_of_a_smooth_sphere() {
    let folder = Folder::new();
    let file = folder.sample("ball.relief", &Sample { q: flat, ..Sample::new(Body::moon(), 8) });
    for (lon, lat) in [(0.0, 0.0), (-179.9f64, 23.0f64), (77.0, -88.5)] {
        reliefd(&format!("mask FILE --sun {lon},{lat} -o OUT/a.png"), &file).good();
        let (width, height, _, lit) = png(&folder.path("a.png"));
        assert_eq!((width, height), (512, 257));
        let unit = |lon: f64, lat: f64| {
            let (lon, lat) = (lon.to_radians(), lat.to_radians());
            [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()]
        };
        let sun = unit(lon, lat);
        let mut days = 0;
        for (k, &lit) in lit.iter().enumerate() {
            let (i, j) = (k % 512, row(k / 512, 257));
            let up = unit(-180.0 + i as f64 * 360.0 / 512.0, -90.0 + j as f64 * 180.0 / 256.0);
            let sine: f64 = (0..3).map(|a| up[a] * sun[a]).sum();
            // A tenth of a degree about the horizon is left to the kernels' own tests.
            if sine.abs() > 0.002 {
                assert_eq!(lit, if sine > 0.0 { 255 } else { 0 }, "sun {lon},{lat}: node ({i}, {j}), sine {sine}");
                days += usize::from(lit > 0);
            }
        }
        assert!((days as f64 / lit.len() as f64 - 0.5).abs() < 0.1);
    }
}

#[test]
fn a_mask_for_each_time() {
    let folder = Folder::new();
    let file = folder.sample("earth.relief", &Sample::new(Body::earth(), 8));
    reliefd("mask FILE --times 2026-03-20T00:00:00Z,2026-03-20T12:00:00Z,6h -o OUT/day.png", &file).good();
    let names: Vec<String> = ["00", "06", "12"].map(|h| format!("day_20260320T{h}0000Z.png")).into();
    assert_eq!(folder.names()[..3], names);
    // The day goes west: at midnight the date line has noon, at noon Greenwich.
    for (name, noon) in names.iter().zip([0usize, 384, 256]) {
        let (.., lit) = png(&folder.path(name));
        let equator = &lit[128 * 512..129 * 512];
        // Hills may shade a few nodes.
        let share =
            |middle: usize| (0..200).map(|k| equator[(middle + 512 + k - 100) % 512]).filter(|&v| v == 255).count();
        assert!(share(noon) > 190 && share(noon + 256) < 10, "{name}: {} {}", share(noon), share(noon + 256));
    }
}

/// Windows and levels are parts of the whole.
#[test]
fn windows_are_cut_from_the_whole() {
    let folder = Folder::new();
    let file = folder.sample("earth.relief", &Sample::new(Body::earth(), 9));
    let step = 360.0f64 / 512.0;
    reliefd("mask FILE --sun 100,10 --level 1 -o OUT/whole.png", &file).good();
    reliefd(&format!("mask FILE --sun 100,10 --level 1 --window={},-20,{},30 -o OUT/part.png", 170.0, -150.0), &file)
        .good();
    let (width, height, _, whole) = png(&folder.path("whole.png"));
    assert_eq!((width, height), (512, 257));
    let (part_width, part_height, _, part) = png(&folder.path("part.png"));
    let first = (350.0 / step).ceil() as usize;
    let south = ((-20.0f64 + 90.0) / step).ceil() as usize;
    assert_eq!((part_width, part_height), (57, 71));
    for (k, &lit) in part.iter().enumerate() {
        let (i, j) = ((first + k % 57) % 512, south + row(k / 57, 71));
        assert_eq!(lit, whole[row(j, 257) * 512 + i], "pixel {k}");
    }
}

/// The kernel and its twin, on a globe and a plane, and the sweep.
#[test]
fn backends_agree() {
    let folder = Folder::new();
    let globe = folder.sample("earth.relief", &Sample::new(Body::earth(), 9));
    let plane = folder.sample("plane.relief", &plane(wavy_q));
    for (file, sun) in
        [(&globe, "--sun 100,10 --soft --level 1"), (&plane, "--sun 213,4 --soft"), (&plane, "--sun 213,4")]
    {
        let masks = backends().into_iter().map(|backend| {
            let stats = reliefd(&format!("mask FILE {sun} --backend {backend} -o OUT/a.png --stats"), file).json(0);
            assert!(stats["rays"].as_u64() >= Some(256 * 256), "{stats}");
            let counted = stats["fetches_per_ray"].as_f64();
            assert!(counted.is_none_or(|fetches| (1.0..100.0).contains(&fetches)), "{stats}");
            png(&folder.path("a.png")).3
        });
        let masks: Vec<Vec<u8>> = masks.collect();
        assert!(masks[0].contains(&0) && masks[0].contains(&255));
        for mask in &masks[1..] {
            let differ = mask.iter().zip(&masks[0]).filter(|(a, b)| a.abs_diff(**b) > 1).count();
            // The sweep and a GPU's own arithmetic round rays that graze in their own way.
            assert!(differ * 1000 <= mask.len(), "{sun}: {differ} of {} nodes differ", mask.len());
        }
    }
}

/// Air lifts the sun by half a degree at the horizon: day reaches further.
#[test]
fn air_lengthens_the_day() {
    let folder = Folder::new();
    let file = folder.sample("ball.relief", &Sample { q: flat, ..Sample::new(Body::earth(), 8) });
    let lit = |air: &str| {
        let words = format!("mask FILE --sun 0.2,0 --window=80,-0.1,100,0.1 --backend cpu -o OUT/a.png {air}");
        reliefd(&words, &file).good();
        png(&folder.path("a.png")).3.iter().filter(|&&v| v == 255).count()
    };
    // Nodes at 80.16 + 0.703 k degrees east: day ends at 90.2 without air and at 90.7 with it.
    assert_eq!((lit(""), lit("--air 1")), (15, 16));
}
