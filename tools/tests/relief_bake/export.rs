//! `relief-bake export` as a user runs it; the GeoTIFFs are read back through GDAL.

use std::path::Path;

use crate::common::{Folder, Sample, earth, plane, wavy_q};
use gdal::{Dataset, Metadata as _};
use relief_formats::body::Body;
use relief_formats::grid::Grid;

struct Raster {
    dataset: Dataset,
    width: usize,
    height: usize,
    values: Vec<f64>,
    /// Centre of the pixel (0, 0) and the step to the next, x to the right, y down.
    frame: [f64; 4],
}

impl Raster {
    fn read(path: &Path) -> Self {
        let dataset = Dataset::open(path).unwrap();
        let (width, height) = dataset.raster_size();
        let g = dataset.geo_transform().unwrap();
        assert_eq!((g[2], g[4]), (0.0, 0.0));
        let band = dataset.rasterband(1).unwrap();
        let values = band.read_as::<f64>((0, 0), (width, height), (width, height), None).unwrap().data().to_vec();
        let frame = [g[0] + g[1] / 2.0, g[3] + g[5] / 2.0, g[1], g[5]];
        assert_eq!(dataset.metadata_item("LAYOUT", "IMAGE_STRUCTURE").as_deref(), Some("COG"));
        Self { width, height, values, frame, dataset }
    }

    fn at(&self, x: usize, y: usize) -> f64 {
        self.values[y * self.width + x]
    }

    fn kind(&self) -> String {
        self.dataset.rasterband(1).unwrap().band_type().name()
    }

    fn void(&self) -> Option<f64> {
        self.dataset.rasterband(1).unwrap().no_data_value()
    }

    /// Every pixel is the node of `level` that lies at its centre.
    fn holds_nodes(&self, grid: Grid, level: u32, step_m: f64) {
        for y in 0..self.height {
            for x in 0..self.width {
                let (lon, lat) = (self.frame[0] + self.frame[2] * x as f64, self.frame[1] + self.frame[3] * y as f64);
                let i = (lon + 180.0) / grid.spacing_deg(level);
                let j = (lat + 90.0) / grid.spacing_deg(level);
                assert!((i - i.round()).abs() < 1e-6 && (j - j.round()).abs() < 1e-6, "pixel ({x}, {y}): {lon} {lat}");
                let node = (i.round().rem_euclid(f64::from(grid.width(level))) as u32, j.round() as u32);
                let expected = f64::from(wavy_q(grid, node.0 << level, node.1 << level)) * step_m;
                assert_eq!(self.at(x, y), expected, "pixel ({x}, {y}), node {node:?}");
            }
        }
    }
}

#[test]
fn every_node_is_where_the_georeference_says() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(9));
    let grid = Grid::new(9, false);
    for level in [0, 1] {
        let out = folder.path("a.tif");
        let run = relief_bake!("export", file, "-o", out, "--level", level.to_string(), "--force");
        assert_eq!((run.code, run.stderr.as_str()), (0, ""));
        let raster = Raster::read(&out);
        assert_eq!((raster.width, raster.height), (1024 >> level, (512 >> level) + 1));
        assert_eq!((raster.frame[0], raster.frame[1]), (-180.0, 90.0));
        assert_eq!((raster.kind().as_str(), raster.void()), ("Float32", None));
        assert_eq!(raster.dataset.spatial_ref().unwrap().auth_code().unwrap(), 4326);
        raster.holds_nodes(grid, level, 1.0 / 16.0);
    }
    assert_eq!(folder.names(), ["a.relief", "a.tif"]);
}

#[test]
fn a_window_may_cross_the_antimeridian() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &Sample { step_exponent: 0, ..earth(8) });
    let grid = Grid::new(8, false);
    let out = folder.path("a.tif");
    let run = relief_bake!("export", file, "-o", out, "--window", "170.1,-20,-170,19.9");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let raster = Raster::read(&out);
    let spacing = grid.spacing_deg(0);
    assert!(raster.frame[0] >= 170.1 && raster.frame[0] < 170.1 + spacing);
    let east = raster.frame[0] + spacing * (raster.width - 1) as f64;
    assert!(east <= 190.0 && east > 190.0 - spacing, "{east}");
    let south = raster.frame[1] - spacing * (raster.height - 1) as f64;
    assert!(raster.frame[1] <= 19.9 && south >= -20.0 && south < -20.0 + spacing);
    assert_eq!(raster.kind(), "Int16");
    raster.holds_nodes(grid, 0, 1.0);
}

#[test]
fn voids_are_nodata_only_where_they_are_void() {
    let folder = Folder::new();
    let filled = |i: u32, j: u32| (10..20).contains(&i) && j == 100;
    let out = folder.path("a.tif");
    for (step_exponent, fill, void) in
        [(0, "none", Some(-32768.0)), (-1, "none", Some(f64::NAN)), (0, "interpolate", None)]
    {
        let file = folder.sample("a.relief", &Sample { step_exponent, fill, filled, ..earth(8) });
        assert_eq!(relief_bake!("export", file, "-o", out, "--force").code, 0);
        let raster = Raster::read(&out);
        assert_eq!(raster.void().map(|v| v.to_string()), void.map(|v: f64| v.to_string()));
        let row = 256 - 100;
        let is_void =
            |x: usize| void.is_some_and(|v| v == raster.at(x, row) || v.is_nan() && raster.at(x, row).is_nan());
        assert_eq!([9, 10, 19, 20].map(is_void), [false, void.is_some(), void.is_some(), false]);
    }
}

#[test]
fn extremes_bound_their_cells_and_other_planes_have_values() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &Sample { filled: |i, _| i == 7, ..earth(9) });
    let read = |plane: &str, level: &str| {
        let out = folder.path(&format!("{plane}.tif"));
        let run = relief_bake!("export", file, "-o", out, "--plane", plane, "--level", level);
        assert_eq!(run.code, 0, "{}", run.stderr);
        Raster::read(&out)
    };
    let (low, high) = (read("hext-min", "1"), read("hext-max", "1"));
    let cell = 180.0 / 128.0;
    assert_eq!((low.width, low.height, low.frame[0], low.frame[1]), (256, 128, -180.0 + cell / 2.0, 90.0 - cell / 2.0));
    let grid = Grid::new(9, false);
    for j in 0..=512u32 {
        for i in 0..1024u32 {
            let height_m = f64::from(wavy_q(grid, i, j)) / 16.0;
            for (x, y) in [(i / 4, j / 4), (i.saturating_sub(1) / 4, j.saturating_sub(1) / 4)] {
                let (x, y) = (x as usize, 127 - y.min(127) as usize);
                assert!(low.at(x, y) <= height_m && height_m <= high.at(x, y), "node ({i}, {j})");
            }
        }
    }
    let deviation = read("deviation", "0");
    assert!(deviation.values.iter().all(|&v| v >= 0.0) && deviation.values.iter().any(|&v| v > 0.0));
    assert_eq!(deviation.at(4, 512 - 6), 0.0);
    assert_eq!(read("mip", "0").values.len(), 1024 * 513);
    let filled = read("filled", "0");
    assert_eq!((filled.kind().as_str(), filled.at(7, 5), filled.at(8, 5)), ("Byte", 1.0, 0.0));
}

#[test]
fn other_bodies_and_planes_keep_their_crs() {
    let folder = Folder::new();
    let out = folder.path("a.tif");
    let moon = folder.sample("moon.relief", &Sample::new(Body::moon(), 8));
    assert_eq!(relief_bake!("export", moon, "-o", out).code, 0);
    let crs = Raster::read(&out).dataset.spatial_ref().unwrap();
    assert_eq!((crs.semi_major().unwrap(), crs.semi_minor().unwrap()), (1_737_400.0, 1_737_400.0));
    let local = folder.sample("plane.relief", &plane(8));
    assert_eq!(relief_bake!("export", local, "-o", out, "--force").code, 0);
    let raster = Raster::read(&out);
    assert_eq!((raster.width, raster.height), (256, 256));
    assert_eq!(raster.frame, [500_000.0, 4_000_000.0 + 20.0 * 255.0, 30.0, -20.0]);
    assert_eq!(raster.dataset.spatial_ref().unwrap().auth_code().unwrap(), 32611);
    assert_eq!(raster.at(3, 255), f64::from(wavy_q(Grid::new(8, true), 3, 0)) / 16.0);
}

#[test]
fn the_mesh_is_a_glb() {
    let folder = Folder::new();
    for (name, sample) in [("a", earth(8)), ("b", plane(8))] {
        let file = folder.sample(&format!("{name}.relief"), &sample);
        let out = folder.path(&format!("{name}.glb"));
        let run = relief_bake!("export", file, "-o", out);
        assert_eq!(run.code, 0, "{}", run.stderr);
        let bytes = std::fs::read(&out).unwrap();
        assert_eq!(
            (&bytes[..4], bytes.len() as u32),
            (&b"glTF"[..], u32::from_le_bytes(bytes[8..12].try_into().unwrap()))
        );
        let json_bytes = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let document: crate::common::Value = serde_json::from_slice(&bytes[20..20 + json_bytes]).unwrap();
        assert_eq!(document["images"][0]["mimeType"], "image/png");
        assert!(run.stdout.contains("vertices"), "{}", run.stdout);
    }
}

#[test]
fn what_cannot_be_written_is_refused_and_nothing_stays() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(8));
    let out = folder.path("a.tif");
    std::fs::write(&out, "precious").unwrap();
    relief_bake!("export", file, "-o", out).refused(&["exists", "--force"]);
    relief_bake!("export", file, "-o", folder.path("a.png")).refused(&[".tif or .glb"]);
    relief_bake!("export", file, "-o", folder.path("none/a.tif")).refused(&["none"]);
    relief_bake!("export", file, "-o", folder.path("b.tif"), "--level", "1").refused(&["--level 1"]);
    relief_bake!("export", file, "-o", folder.path("b.tif"), "--window", "0.1,0.1,0.2,0.2").refused(&["at least one"]);
    relief_bake!("export", file, "-o", folder.path("b.glb"), "--level", "0").refused(&["--level"]);
    assert_eq!(relief_bake!("export", file, "-o", folder.path("b.tif"), "--plane", "colour").code, 2);
    let mut bytes = std::fs::read(&file).unwrap();
    let late = bytes.len() - 3000;
    bytes[late] ^= 0x55;
    std::fs::write(folder.path("bad.relief"), bytes).unwrap();
    relief_bake!("export", folder.path("bad.relief"), "-o", folder.path("b.tif")).refused(&["bad.relief", "damaged"]);
    assert_eq!(std::fs::read(&out).unwrap(), b"precious");
    assert_eq!(folder.names(), ["a.relief", "a.tif", "bad.relief"]);
}
