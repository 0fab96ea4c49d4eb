//! `relief-bake diff` as a user runs it.

use crate::common::{Body, Folder, Sample, earth, plane, wavy_q};
use relief_formats::file::{Plane, Relief};
use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;
use relief_tests::png::decode;

/// Node (301, 203), in tile (1, 0) of level 0, is 3 m higher.
fn one_node_higher(grid: Grid, i: u32, j: u32) -> i32 {
    wavy_q(grid, i, j) + if (i, j) == (301, 203) { 48 } else { 0 }
}

#[test]
fn equal_content_is_equal_at_once() {
    let folder = Folder::new();
    let (a, b) = (folder.sample("a.relief", &earth(9)), folder.sample("b.relief", &Sample { fill: "0", ..earth(9) }));
    // Not a tile of them can be decoded, which shows that none is.
    for path in [&a, &b] {
        let relief = Relief::open(path).unwrap();
        let mut bytes = std::fs::read(path).unwrap();
        let section = relief.sections().iter().find(|s| s.kind == *b"TILE").unwrap();
        bytes[section.offset as usize..][..section.length as usize].fill(0xff);
        drop(relief);
        std::fs::write(path, bytes).unwrap();
    }
    let result = relief_bake!("diff", a, b, "--json").json(0);
    assert_eq!((&result["identical"], &result["different"]), (&true.into(), &false.into()));
    assert_eq!(result["facts"]["fill"], serde_json::json!(["none", "0"]));
    assert!(relief_bake!("diff", a, b).stdout.contains("identical content"));
}

#[test]
fn one_node_is_found_and_placed() {
    let folder = Folder::new();
    let a = folder.sample("a.relief", &earth(9));
    let b = folder.sample("b.relief", &Sample { q: one_node_higher, ..earth(9) });
    let result = relief_bake!("diff", a, b, "--json").json(1);
    let largest = &result["largest"];
    assert_eq!((&result["largest_m"], &largest["difference_m"]), (&3.0.into(), &3.0.into()));
    assert_eq!((&largest["level"], &largest["tile"]), (&0.into(), &serde_json::json!([1, 0])));
    let grid = Grid::new(9, false);
    assert_eq!(largest["lon_deg"], grid.lon_deg(0, 301));
    assert_eq!(largest["lat_deg"], grid.lat_deg(0, 203));
    let rms = result["rms_m"].as_f64().unwrap();
    assert!((rms - 3.0 / f64::from(1024 * 512).sqrt()).abs() < 1e-12, "{rms}");
    let levels: Vec<_> = (0..2).map(|k| result["levels"][k]["nodes_different"].as_u64().unwrap()).collect();
    assert_eq!(levels, [1, 0]);
    assert_eq!(result["planes"]["nodes"], 1);
    assert!(result["planes"]["mip"].as_u64().unwrap() > 0);
    let back = relief_bake!("diff", b, a, "--json").json(1);
    assert_eq!(back["largest"]["difference_m"], -3.0);
    let text = relief_bake!("diff", a, b);
    assert!(text.code == 1 && text.stdout.contains("largest       3 m"), "{}", text.stdout);
    for (tolerance, code) in [("2.99", 1), ("3", 0), ("10", 0)] {
        assert_eq!(relief_bake!("diff", a, b, "--tolerance", tolerance).code, code, "{tolerance}");
    }
}

#[test]
fn only_what_differs_is_decoded() {
    let folder = Folder::new();
    let a = folder.sample("a.relief", &earth(9));
    let b = folder.sample("b.relief", &Sample { q: one_node_higher, ..earth(9) });
    let spoil = |key: TileKey| {
        let relief = Relief::open(&b).unwrap();
        let entry = relief.find(key).unwrap().unwrap();
        let plane = relief.plane_bytes(&entry, Plane::Nodes);
        let at = plane.as_ptr() as usize - relief.bytes().as_ptr() as usize;
        let middle = at + plane.len() / 2;
        let mut bytes = relief.bytes().to_vec();
        bytes[middle] ^= 0xff;
        drop(relief);
        std::fs::write(&b, bytes).unwrap();
    };
    spoil(TileKey::new(0, 3, 1));
    assert_eq!(relief_bake!("diff", a, b, "--json").json(1)["largest_m"], 3.0);
    spoil(TileKey::new(0, 1, 0));
    relief_bake!("diff", a, b).refused(&["b.relief", "damaged tile"]);
}

#[test]
fn other_planes_and_steps_count_without_a_tolerance() {
    let folder = Folder::new();
    let a = folder.sample("a.relief", &earth(8));
    let marked = folder.sample("b.relief", &Sample { filled: |i, j| (i, j) == (3, 5), ..earth(8) });
    let result = relief_bake!("diff", a, marked, "--json").json(1);
    assert_eq!((&result["planes"]["filled"], &result["planes"]["nodes"]), (&1.into(), &0.into()));
    assert!(result["largest"].is_null());
    assert_eq!(relief_bake!("diff", a, marked, "--tolerance", "0.001").code, 0);
    let finer = Sample { step_exponent: -5, q: |grid, i, j| 2 * wavy_q(grid, i, j), ..earth(8) };
    let finer = folder.sample("c.relief", &finer);
    let result = relief_bake!("diff", a, finer, "--json").json(1);
    assert_eq!(
        (&result["largest_m"], &result["facts"]["step_m"]),
        (&0.0.into(), &serde_json::json!([0.0625, 0.03125]))
    );
    assert_eq!(relief_bake!("diff", a, finer, "--tolerance", "0.001").code, 0);
}

#[test]
fn a_missing_tile_is_compared_with_its_interpolation() {
    let folder = Folder::new();
    let a = folder.sample("a.relief", &earth(9));
    let b = folder.sample("b.relief", &Sample { absent: |key| key == TileKey::new(0, 2, 1), ..earth(9) });
    let result = relief_bake!("diff", a, b, "--json").json(1);
    assert_eq!((&result["levels"][0]["tiles_only_a"], &result["levels"][0]["tiles_only_b"]), (&1.into(), &0.into()));
    let most = result["largest_m"].as_f64().unwrap();
    // The formula jumps at the pole; half of that is what an interpolated node may be off.
    assert!(most > 0.0 && most < 200.0, "{most}");
    assert_eq!(result["largest"]["tile"], serde_json::json!([2, 1]));
    // Nodes that the coarser level has, a quarter, are the same.
    let nodes = result["levels"][0]["nodes_different"].as_u64().unwrap();
    assert!(nodes > 30_000 && nodes <= 65_536 * 3 / 4, "{nodes}");
}

#[test]
fn a_map_shows_where() {
    let folder = Folder::new();
    let a = folder.sample("a.relief", &earth(9));
    let b = folder.sample("b.relief", &Sample { q: one_node_higher, ..earth(9) });
    let out = folder.path("d.png");
    assert_eq!(relief_bake!("diff", a, b, "--png", out).code, 1);
    let (width, height, 3, pixels) = decode(&std::fs::read(&out).unwrap()) else { panic!("not RGB") };
    assert_eq!((width, height), (1024, 512 + 34));
    let at = |x: usize, y: usize| &pixels[3 * (y * 1024 + x)..][..3];
    let [neutral, higher] = [at(10, 10), at(301, 511 - 203)];
    assert!(neutral.iter().all(|&c| c > 240), "{neutral:?}");
    assert!(higher[0] > 2 * higher[1] && higher[0] > 2 * higher[2], "{higher:?}");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = Folder::new();
    let a = folder.sample("a.relief", &earth(8));
    let refused = |b: &Sample, words: &[&str]| {
        let b = folder.sample("b.relief", b);
        relief_bake!("diff", a, b).refused(words);
    };
    refused(&earth(9), &["m is 8 in A and 9 in B"]);
    refused(&Sample::new(Body::moon(), 8), &["semi-axes", "1737400"]);
    refused(&plane(8), &["plane"]);
    relief_bake!("diff", a, folder.path("none.relief")).refused(&["none.relief"]);
    relief_bake!("diff", a, a, "--tolerance", "-1").refused(&["--tolerance -1"]);
    relief_bake!("diff", a, a, "--tolerance", "NaN").refused(&["--tolerance NaN"]);
}
