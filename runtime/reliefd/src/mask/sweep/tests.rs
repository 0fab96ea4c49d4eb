#![allow(clippy::unwrap_used, reason = "a test ends at the first thing that goes wrong")]

use relief_formats::body::Body;
use relief_formats::file::Relief;
use relief_formats::grid::Grid;

use super::*;
use relief_tests::sample_file::{Sample, wavy_q};

fn planet(q: fn(Grid, u32, u32) -> i32) -> Arc<Planet> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plane.relief");
    let body = Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: 30.0, dy: 30.0 };
    Sample { q, ..Sample::new(body, 9) }.write(&path);
    Planet::new(Relief::open(&path).unwrap(), 0).unwrap()
}

/// A corner that is lower than sixteen bits reach, in shadow for itself only.
fn deep(grid: Grid, i: u32, j: u32) -> i32 {
    if (i, j) == (511, 0) { -100_000 } else { wavy_q(grid, i, j) }
}

const LOW: [f32; 3] = [-0.8, 0.592, 0.1];

#[test]
fn narrow_and_wide_heights_shade_alike() {
    let [narrow, wide] = [wavy_q, deep].map(|q| Sweep::new(planet(q), 0).unwrap());
    assert!(matches!(narrow.nodes, Nodes::Narrow { .. }) && matches!(wide.nodes, Nodes::Wide(_)));
    // A window without the corner and what its hole lets through.
    let window = Rectangle { column: 0, row: 20, columns: 480, rows: 490 };
    let [a, b] = [&narrow, &wide].map(|sweep| sweep.mask(LOW, window));
    assert!(a == b && a.contains(&0) && a.contains(&255));
    assert_ne!(a, narrow.mask([0.8, 0.592, 0.1], window));
}

/// Bounds that the heights do not keep are not believed.
#[test]
fn heights_beyond_the_bounds_are_kept_wide() {
    let planet = planet(wavy_q);
    let tiles = Tiles::for_level(planet.relief(), 0, 1);
    let header = planet.relief().header();
    assert!(narrow(&tiles, 0, [header.min_q, header.max_q]).unwrap().is_some());
    assert!(narrow(&tiles, 0, [header.min_q + 1, header.max_q]).unwrap().is_none());
    assert!(narrow(&tiles, 0, [header.min_q - 65_536, header.min_q - 1]).unwrap().is_none());
}

#[test]
fn rectangles_are_cut_in_place() {
    let (stride, rows) = (7, 5);
    let lit: Vec<u8> = (0..stride * rows).map(|k| u8::from(k % 3 == 0)).collect();
    for (column, row, columns, count) in [(0, 0, 7, 5), (2, 1, 4, 3), (6, 4, 1, 1), (0, 3, 7, 2)] {
        let rectangle = Rectangle { column, row, columns, rows: count };
        let expected: Vec<u8> = (row..row + count)
            .rev()
            .flat_map(|y| (column as u32..column as u32 + columns).map(move |x| (y as usize, x as usize)))
            .map(|(y, x)| 255 * lit[y * stride + x])
            .collect();
        assert_eq!(cut(lit.clone(), stride, rectangle), expected);
    }
}
