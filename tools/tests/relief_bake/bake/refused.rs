//! What cannot be baked is refused with the file, the value, the rule and the remedy, and exit
//! code 2; the folder is then as it was.

mod outputs;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::common::rasters::Raster;
use crate::common::{Folder, data};
use gdal::raster::RasterCreationOptions;
use gdal::{Dataset, DriverManager, Metadata as _};

const WORLD: &str = "--bounds=-180,-90,180,90";

/// Names and contents of a folder.
fn contents(folder: &Folder) -> BTreeMap<String, Option<Vec<u8>>> {
    folder.names().into_iter().map(|name| (name.clone(), std::fs::read(folder.path(&name)).ok())).collect()
}

/// Bakes to `output` and expects a refusal with all of `words`.
fn refused_as(folder: &Folder, output: &Path, source: impl AsRef<OsStr>, options: &[&str], words: &[&str]) {
    let before = contents(folder);
    let mut arguments: Vec<&OsStr> = ["bake", "--quiet", "-o"].map(OsStr::new).into();
    arguments.extend([output.as_os_str(), source.as_ref()]);
    arguments.extend(options.iter().map(OsStr::new));
    let run = crate::common::run(&arguments, None);
    run.refused(&[words, &["rule:"]].concat());
    unchanged(folder, &before);
}

fn unchanged(folder: &Folder, before: &BTreeMap<String, Option<Vec<u8>>>) {
    assert!(contents(folder) == *before, "{:?} became {:?}", before.keys(), folder.names());
}

/// The same with an output of its own.
fn refused(folder: &Folder, source: impl AsRef<OsStr>, options: &[&str], words: &[&str]) {
    refused_as(folder, &folder.path("out.relief"), source, options, words);
}

fn vrt(folder: &Folder, name: &str, inside: &str) -> PathBuf {
    let path = folder.path(name);
    let text = format!(r#"<VRTDataset rasterXSize="64" rasterYSize="32">{inside}</VRTDataset>"#);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn inputs_that_are_no_rasters() {
    let folder = Folder::new();
    refused(&folder, folder.path("none.tif"), &[], &["none.tif", "No such file"]);
    std::fs::write(folder.path("text.tif"), "not a raster").unwrap();
    refused(&folder, folder.path("text.tif"), &[], &["text.tif", "not a raster"]);
    std::fs::write(folder.path("zero.tif"), "").unwrap();
    refused(&folder, folder.path("zero.tif"), &[], &["zero.tif", "0 bytes"]);
    std::fs::write(folder.path("zero.exr"), "").unwrap();
    refused(&folder, folder.path("zero.exr"), &[WORLD], &["zero.exr"]);
    refused(&folder, folder.path("none.exr"), &[WORLD], &["none.exr"]);
    std::fs::create_dir(folder.path("folder.tif")).unwrap();
    refused(&folder, folder.path("folder.tif"), &[], &["folder.tif", "is a folder"]);
    refused(&folder, vrt(&folder, "bandless.vrt", ""), &[], &["bandless.vrt", "bands"]);
    // A container of two rasters has no band of its own.
    let one = folder.path("one.tif");
    Raster::world(64).write(&one, |x, y| (x * y) as i16);
    let driver = DriverManager::get_driver_by_name("GPKG").unwrap();
    let two = folder.path("two.gpkg");
    for options in [&["RASTER_TABLE=a"][..], &["RASTER_TABLE=b", "APPEND_SUBDATASET=YES"]] {
        let options: RasterCreationOptions = options.iter().copied().collect();
        Dataset::open(&one).unwrap().create_copy(&driver, &two, &options).unwrap().close().unwrap();
    }
    refused(&folder, two, &[], &["two.gpkg", "no raster band", "two.gpkg:b"]);
    let earth = data("earth_etopo1_6min.tif");
    refused(&folder, earth, &["--channel", "7"], &["earth_etopo1_6min.tif", "\"7\""]);
}

#[test]
fn inputs_that_lie_nowhere_known() {
    let folder = Folder::new();
    let path = folder.path("nowhere.tif");
    Raster { transform: None, epsg: 0, ..Raster::world(64) }.write(&path, |x, y| (x * y) as f32);
    refused(&folder, &path, &["--vertical", "ellipsoid"], &["nowhere.tif", "no georeference", "--bounds"]);
    let path = folder.path("no_crs.tif");
    Raster { epsg: 0, ..Raster::world(64) }.write(&path, |x, y| (x * y) as f32);
    refused(&folder, &path, &["--vertical", "ellipsoid"], &["no_crs.tif", "no coordinate reference system"]);

    Raster::world(64).write(&folder.path("world.tif"), |x, y| (x * y) as f32);
    let band = r#"<GeoTransform>-180,5.625,0,90,0,-5.625</GeoTransform><VRTRasterBand dataType="Float32" band="1">
        <SimpleSource><SourceFilename relativeToVRT="1">world.tif</SourceFilename></SimpleSource></VRTRasterBand>"#;
    let local = format!(r#"<SRS>LOCAL_CS["somewhere",UNIT["metre",1]]</SRS>{band}"#);
    let local = vrt(&folder, "local.vrt", &local);
    refused(&folder, local, &["--vertical", "ellipsoid"], &["local.vrt", "CRS"]);
    let metres = band.replace("-180,5.625", "500000,30").replace("90,0,-5.625", "5000000,0,-30");
    let metres = vrt(&folder, "metres.vrt", &format!("<SRS>EPSG:4326</SRS>{metres}"));
    refused(&folder, metres, &["--vertical", "ellipsoid"], &["metres.vrt", "latitude"]);
    let flat = band.replace("-180,5.625,0,90,0,-5.625", "0,0,0,0,0,0");
    let flat = vrt(&folder, "flat.vrt", &format!("<SRS>EPSG:4326</SRS>{flat}"));
    refused(&folder, flat, &["--vertical", "ellipsoid"], &["flat.vrt", "geotransform"]);
}

#[test]
fn heights_above_who_knows_what() {
    let folder = Folder::new();
    let earth = data("earth_etopo1_6min.tif");
    refused(&folder, &earth, &[], &["earth_etopo1_6min.tif", "--vertical egm96"]);
    refused(&folder, &earth, &["--vertical", "msl"], &["msl", "ellipsoid"]);
    refused(&folder, &earth, &["--vertical", "none/geoid.gtx"], &["none/geoid.gtx"]);
    let moon = data("moon_dem_halfmetre_dn.tif");
    refused(&folder, moon, &["--vertical", "egm96"], &["moon_dem_halfmetre_dn.tif"]);
}

#[test]
fn nothing_but_voids() {
    let folder = Folder::new();
    let path = folder.path("void.tif");
    Raster { nodata: Some(-32768.0), ..Raster::world(64) }.write(&path, |_, _| -32768i16);
    refused(&folder, &path, &["--vertical", "ellipsoid"], &["void.tif", "void", "--nodata"]);
    let path = folder.path("nan.tif");
    Raster::world(64).write(&path, |_, _| f32::NAN);
    for fill in ["none", "interpolate", "100"] {
        refused(&folder, &path, &["--vertical", "ellipsoid", "--fill", fill], &["nan.tif", "void"]);
    }
    refused(&folder, &path, &["--body", "plane", "--vertical", "as-given"], &["nan.tif", "void"]);
}

/// Where a block of a TIFF starts in its file.
fn block_offset(path: &Path, column: usize, row: usize) -> usize {
    let file = Dataset::open(path).unwrap();
    let band = file.rasterband(1).unwrap();
    band.metadata_item(&format!("BLOCK_OFFSET_{column}_{row}"), "TIFF").unwrap().parse().unwrap()
}

#[test]
fn damaged_tiffs() {
    let folder = Folder::new();
    let path = folder.path("damaged.tif");
    let earth = data("earth_etopo1_6min.tif");
    let whole = std::fs::read(&earth).unwrap();
    let mut damaged = whole.clone();
    damaged[block_offset(&earth, 7, 4)..][..64].fill(0xff);
    std::fs::write(&path, &damaged).unwrap();
    refused(&folder, &path, &["--vertical", "ellipsoid"], &["damaged.tif", "the file is damaged"]);
    // Small memory: blocks are read one by one.
    refused(&folder, &path, &["--vertical", "ellipsoid", "--memory", "1MiB"], &["damaged.tif", "the file is damaged"]);
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    refused(&folder, &path, &["--vertical", "ellipsoid"], &["damaged.tif"]);

    let strips = folder.path("strips.tif");
    Raster { options: &["COMPRESS=DEFLATE", "BLOCKYSIZE=16"], ..Raster::world(512) }
        .write(&strips, |x, y| (x * y) as f32);
    let mut bytes = std::fs::read(&strips).unwrap();
    bytes[block_offset(&strips, 0, 8)..][..16].fill(0);
    std::fs::write(&strips, bytes).unwrap();
    refused(&folder, &strips, &["--vertical", "ellipsoid"], &["strips.tif", "the file is damaged"]);
}

#[test]
fn damaged_exrs() {
    let folder = Folder::new();
    let options = [WORLD, "--vertical", "ellipsoid"];
    for name in ["invalid.exr", "comp_bad_bounds_piz.exr", "comp_early_eof_piz.exr"] {
        refused(&folder, data("exr").join(name), &options, &[name, "whole"]);
        refused(&folder, data("exr").join(name), &[&options[..], &["--channel", "R"]].concat(), &[name, "whole"]);
    }
    // Its mip levels are more than an integer counts.
    refused(&folder, data("exr/tiled.exr"), &[&options[..], &["--channel", "G"]].concat(), &["tiled.exr", "whole"]);
    let path = folder.path("cut.exr");
    let whole = std::fs::read(data("exr/earth_1024_f32_zip.exr")).unwrap();
    for length in [3, 100, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        refused(&folder, &path, &options, &["cut.exr"]);
    }
    let mut damaged = whole.clone();
    damaged[whole.len() / 2..][..500].fill(0xff);
    std::fs::write(&path, damaged).unwrap();
    refused(&folder, &path, &options, &["cut.exr"]);
    let two = data("exr/earth_1024_f32_nan_inf.exr");
    refused(&folder, &two, &options, &["nan_inf.exr", "B, G, R", "--channel"]);
    refused(&folder, two, &[&options[..], &["--channel", "Z"]].concat(), &["nan_inf.exr", "Z", "B, G, R"]);
}

#[test]
fn numbers_out_of_range() {
    let folder = Folder::new();
    let moon = data("moon_dem_halfmetre_dn.tif");
    let earth = data("earth_etopo1_6min.tif");
    let exr = data("exr/earth_1024_f32_zip.exr");
    refused(&folder, &moon, &["--m", "7"], &["m = 7", "8 to 20", "--m 8"]);
    refused(&folder, &moon, &["--m", "21"], &["m = 21", "8 to 20", "--m 20"]);
    // 1 m lidar asks for more than a globe's 20 levels.
    let lidar = data("lidar_1m_utm15n.tif");
    refused(&folder, lidar, &["--vertical", "ellipsoid"], &["finest source", "8 to 20", "--m 20"]);
    refused(&folder, &moon, &["--step", "0.3"], &["0.3", "power of two", "0.25"]);
    for step in ["1e-30", "1e30"] {
        let near = step.parse::<f64>().unwrap().log2().floor().exp2().to_string();
        refused(&folder, &moon, &["--step", &near], &["2^", "--step"]);
    }
    for bad in ["0", "-1", "NaN", "inf", "one"] {
        refused(&folder, &moon, &[&format!("--step={bad}")], &[bad, "--step"]);
        refused(&folder, &moon, &[&format!("--max-error={bad}")], &[bad, "--max-error"]);
    }
    refused(
        &folder,
        &earth,
        &["--vertical", "ellipsoid", "--step", "0.0009765625"],
        &["steps of 0.0009765625", "2^23", "--step"],
    );
    refused(&folder, &moon, &["--fill", "1e9"], &["1000000000", "2^23"]);
    refused(&folder, &moon, &["--fill", "NaN"], &["NaN"]);
    refused(&folder, &moon, &["--scale", "NaN"], &["NaN", "scale"]);
    refused(&folder, &moon, &["--scale", "0"], &["scale"]);
    refused(&folder, &moon, &["--offset", "inf"], &["inf", "offset"]);
    refused(&folder, &moon, &["--threads", "0"], &["--threads 0"]);
    refused(&folder, &moon, &["--memory", "much"], &["much", "--memory"]);
    refused(&folder, &moon, &["--body", "pluto"], &["pluto", "--body"]);
    for bad in ["NaN,-90,180,90", "-180,-90,180", "-180,-90,inf,90", "a,b,c,d"] {
        refused(&folder, &exr, &["--vertical", "ellipsoid", &format!("--bounds={bad}")], &[bad, "--bounds"]);
    }
    for bad in ["180,-90,-180,90", "-180,90,180,-90", "-180,-91,180,90", "-181,-90,180,90", "0,0,0,0"] {
        refused(&folder, &exr, &["--vertical", "ellipsoid", &format!("--bounds={bad}")], &[bad, "west < east"]);
    }
    refused(&folder, &moon, &[WORLD], &["--bounds", "georeference"]);
}

/// The checker itself: a refusal that leaves something behind is seen.
#[test]
#[should_panic(expected = "became")]
fn what_is_left_behind_is_seen() {
    let folder = Folder::new();
    let log = folder.path("log.txt");
    std::fs::write(&log, "").unwrap();
    let before = contents(&folder);
    std::fs::write(&log, "more").unwrap();
    unchanged(&folder, &before);
}
