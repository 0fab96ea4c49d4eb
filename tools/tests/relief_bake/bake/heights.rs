//! Every file of the test data, baked: each level-0 node is within half a step plus 1 mm of an
//! independent f64 resampler, and its fill flag is right.

use std::ffi::OsStr;
use std::path::PathBuf;

use crate::common::oracle::Question;
use crate::common::{Folder, data};

const WORLD: [&str; 1] = ["--bounds=-180,-90,180,90"];
const ON_ELLIPSOID: [&str; 2] = ["--vertical", "ellipsoid"];

/// Bakes a file of the data with a kernel.
fn bake(folder: &Folder, source: &str, kernel: &str, options: &[&[&str]]) -> PathBuf {
    let (source, file) = (data(source), folder.path(&format!("{kernel}.relief")));
    let mut arguments: Vec<&OsStr> = ["bake", "--quiet", "--resample", kernel, "-o"].map(OsStr::new).into();
    arguments.extend([file.as_os_str(), source.as_os_str()]);
    arguments.extend(options.concat().into_iter().map(OsStr::new));
    let run = crate::common::run(&arguments, None);
    assert_eq!(run.code, 0, "{}", run.stderr);
    file
}

/// Both kernels agree with the oracle on `tiles` tiles.
fn agrees(source: &str, bake_options: &[&[&str]], oracle_options: &[&str], tiles: usize) {
    let folder = Folder::new();
    for kernel in ["nearest", "bilinear"] {
        let file = bake(&folder, source, kernel, bake_options);
        let options = [&["--kernel", kernel], oracle_options].concat();
        let agreement = Question::new(&data(source), &options, tiles).ask(&file);
        assert!(agreement.holds(), "{source}, {kernel}: {agreement:?}");
    }
}

#[test]
fn earth_on_gridline_rows_from_0_to_360() {
    agrees("earth_etopo1_6min.tif", &[&ON_ELLIPSOID], &[], 16);
}

#[test]
fn earth_above_a_geoid() {
    let geoid = "/usr/share/proj/egm96_15.gtx";
    agrees(
        "earth_etopo1_6min.tif",
        &[&["--vertical", "egm96", "--m", "9", "--step", "0.0625"]],
        &["--geoid", geoid],
        8,
    );
}

#[test]
fn moon_in_half_metres() {
    agrees("moon_dem_halfmetre_dn.tif", &[], &[], 8);
}

#[test]
fn a_region_in_degrees() {
    agrees("srtm_n40e040_3s.tif", &[&ON_ELLIPSOID, &["--m", "15"]], &[], 6);
}

#[test]
fn a_region_in_albers() {
    agrees("sierra_albers_30m.tif", &[&ON_ELLIPSOID, &["--m", "16"]], &[], 6);
}

#[test]
fn a_field_in_utm() {
    agrees("lidar_1m_utm15n.tif", &[&ON_ELLIPSOID, &["--m", "18", "--step", "0.0078125"]], &[], 4);
}

#[test]
fn a_field_on_a_plane() {
    agrees("lidar_1m_utm15n.tif", &[&["--body", "plane"]], &[], 4);
}

#[test]
fn sea_floor_with_untagged_nan() {
    agrees("bathymetry_utm30n_nan_untagged.tif", &[&ON_ELLIPSOID, &["--m", "14"]], &[], 4);
    agrees("bathymetry_utm30n_nan_untagged.tif", &[&["--body", "plane"]], &[], 4);
}

#[test]
fn antarctica_around_its_pole() {
    agrees("antarctica_epsg3031.tif", &[&ON_ELLIPSOID, &["--m", "10"]], &[], 8);
}

#[test]
fn fiji_across_the_antimeridian() {
    agrees("fiji_across_180.tif", &[&ON_ELLIPSOID], &[], 4);
}

#[test]
fn an_exr_without_georeference() {
    let name = ["--channel", "height"];
    agrees("exr/earth_1024_f32_zip.exr", &[&ON_ELLIPSOID, &WORLD, &name], &[&WORLD[..], &name].concat(), 8);
}

#[test]
fn an_exr_with_nan_and_infinity() {
    let name = ["--channel", "R"];
    agrees("exr/earth_1024_f32_nan_inf.exr", &[&ON_ELLIPSOID, &WORLD, &name], &[&WORLD[..], &name].concat(), 8);
}

#[test]
fn an_exr_whose_bounds_are_nodes() {
    let nodes = ["--registration", "node", "--channel", "height"];
    agrees("exr/earth_1024_f32_zip.exr", &[&ON_ELLIPSOID, &WORLD, &nodes], &[&WORLD[..], &nodes].concat(), 8);
}

/// Half precision keeps 11 bits: samples are those of the f32 file but for 2^-11 of each, at most
/// 4 m beyond 8192 m. Bilinear heights err by what the samples around them do.
#[test]
fn an_exr_in_half_precision() {
    let folder = Folder::new();
    let exact = data("exr/earth_1024_f32_zip.exr");
    for kernel in ["nearest", "bilinear"] {
        let file = bake(&folder, "exr/earth_1024_f16_piz.exr", kernel, &[&ON_ELLIPSOID, &WORLD, &["--channel", "Y"]]);
        let options = ["--kernel", kernel, WORLD[0], "--channel", "height"];
        let mut question = Question::new(&exact, &options, 8);
        question.relative = 2f64.powi(-11);
        let agreement = question.ask(&file);
        assert!(agreement.flags == 0 && agreement.worst_m < 4.0 + 0.0325, "{kernel}: {agreement:?}");
        assert!(kernel == "bilinear" || agreement.holds(), "{agreement:?}");
    }
}

/// Shifts of half a cell and of a node, bounds of nodes for those of cells, and half a turn.
#[test]
fn a_shift_of_half_a_cell_is_seen() {
    let folder = Folder::new();
    let name = ["--channel", "height"];
    let source = data("exr/earth_1024_f32_zip.exr");
    let file = bake(&folder, "exr/earth_1024_f32_zip.exr", "bilinear", &[&ON_ELLIPSOID, &WORLD, &name]);
    let ask = |bounds: &str, registration: &str, shift: i64| {
        let options = [bounds, "--registration", registration, name[0], name[1]];
        let mut question = Question::new(&source, &options, 8);
        question.shift = shift;
        question.ask(&file)
    };
    assert!(ask(WORLD[0], "cell", 0).holds());
    let shifts = [
        ask("--bounds=-179.82421875,-90,180.17578125,90", "cell", 0),
        ask(WORLD[0], "node", 0),
        ask(WORLD[0], "cell", 1),
        ask("--bounds=0,-90,360,90", "cell", 0),
    ];
    for shifted in shifts {
        assert!(shifted.off > shifted.nodes / 4 && shifted.worst_m > 50.0, "{shifted:?}");
    }
}

/// A wrong fill flag is seen: the bake without NaN is not that of the file with NaN.
#[test]
fn a_wrong_fill_flag_is_seen() {
    let folder = Folder::new();
    let file =
        bake(&folder, "exr/earth_1024_f32_zip.exr", "nearest", &[&ON_ELLIPSOID, &WORLD, &["--channel", "height"]]);
    let source = data("exr/earth_1024_f32_nan_inf.exr");
    let options = ["--kernel", "nearest", WORLD[0], "--channel", "R"];
    let agreement = Question::new(&source, &options, 8).ask(&file);
    assert!(agreement.flags > 100 && !agreement.holds(), "{agreement:?}");
}
