//! Files against the rasters they were baked from.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use relief_formats::mesh::MeshLayout;
use relief_tools::bake::{BakeOptions, bake};
use relief_tools::source::{SourceOptions, Vertical};
use relief_tools::validate::{Against, Check, Level, Options, Report, validate};

use super::assert_only;
use crate::common::Folder;
use crate::common::rasters::Raster;

/// A GeoTIFF of n x n/2 cells over `bounds` (west, south, east, north).
fn tif(
    path: &Path,
    (nx, ny): (usize, usize),
    [west, south, east, north]: [f64; 4],
    value: impl Fn(usize, usize) -> f32,
) -> String {
    let (dx, dy) = ((east - west) / nx as f64, (north - south) / ny as f64);
    let transform = Some([west, dx, 0.0, north, 0.0, -dy]);
    Raster { size: (nx, ny), transform, nodata: Some(-9999.0), ..Raster::world(nx) }.write(path, value);
    path.to_str().unwrap().into()
}

const GLOBE: [f64; 4] = [-180.0, -90.0, 180.0, 90.0];

fn waves(x: usize, y: usize) -> f32 {
    ((x as f32 / 9.0).sin() * (y as f32 / 7.0).cos()).mul_add(800.0, 0.37)
}

fn baked(folder: &Folder, inputs: &[String]) -> std::path::PathBuf {
    let output = folder.path("baked.relief");
    let options = BakeOptions {
        output: output.clone(),
        m: None,
        step_exponent: Some(-3),
        source: SourceOptions { vertical: Some(Vertical::Ellipsoid), ..SourceOptions::default() },
        layout: MeshLayout::Aligned,
        resume: false,
        force: true,
        quiet: true,
    };
    bake(inputs, &options, &AtomicBool::new(false)).unwrap();
    output
}

fn against(file: &Path, inputs: &[String]) -> Report {
    let against = Against { inputs: inputs.to_vec(), ..Against::default() };
    validate(file, &Options { level: Level::Source, against, ..Options::default() }).unwrap()
}

#[test]
fn a_bake_agrees_with_its_source() {
    let folder = Folder::new();
    let world = tif(&folder.path("world.tif"), (512, 256), GLOBE, waves);
    let file = baked(&folder, std::slice::from_ref(&world));
    let report = against(&file, &[world]);
    assert_only(&report, &[]);
    let source = report.source.unwrap();
    assert!(source.nodes >= 512 * 256 && source.max_m <= 0.0625 && source.max_m > 0.05, "{source:?}");
    assert!((source.rms_m - 0.125 / 12f64.sqrt()).abs() < 0.002, "{source:?}");
    assert_eq!((report.level_reached, source.bound_m), (Level::Source, 0.0625));
}

#[test]
fn a_fine_region_and_its_surroundings_agree_with_their_sources() {
    let folder = Folder::new();
    let world = tif(&folder.path("world.tif"), (512, 256), GLOBE, waves);
    let region = tif(&folder.path("region.tif"), (300, 280), [7.0, 44.0, 14.5, 51.0], |x, y| {
        if x < 40 && y < 60 { -9999.0 } else { waves(x, 3 * y) + 2000.0 }
    });
    let inputs = [world, region];
    let file = baked(&folder, &inputs);
    assert_only(&against(&file, &inputs), &[]);
}

#[test]
fn another_source_is_noticed() {
    let folder = Folder::new();
    let world = tif(&folder.path("world.tif"), (512, 256), GLOBE, waves);
    let file = baked(&folder, &[world]);
    let raised = tif(&folder.path("world.tif"), (512, 256), GLOBE, |x, y| {
        waves(x, y) + if (x, y) == (300, 100) { 50.0 } else { 0.0 }
    });
    let report = against(&file, &[raised]);
    assert_only(&report, &[Check::SourceHeight, Check::SourceRecord]);
    assert!(!report.good);
    let place = report.source.unwrap().place.unwrap();
    // Pixel (300, 100) has its centre half a cell south-east of the node that is its corner.
    let (lon, lat) = (place.lon_deg.unwrap(), place.lat_deg.unwrap());
    assert!((lon - (-180.0 + 300.5 * 360.0 / 512.0)).abs() < 0.8, "{lon}");
    assert!((lat - (90.0 - 100.5 * 180.0 / 256.0)).abs() < 0.8, "{lat}");
    let holed = tif(&folder.path("world.tif"), (512, 256), GLOBE, |x, y| {
        if (300..320).contains(&x) && y == 100 { -9999.0 } else { waves(x, y) }
    });
    assert!(against(&file, &[holed]).has(Check::SourceFilled));
    let more = tif(&folder.path("more.tif"), (512, 256), GLOBE, waves);
    assert!(against(&file, &[more.clone(), more]).has(Check::SourceRecord));
}
