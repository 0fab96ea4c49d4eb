//! Sources that trap a bake: seams, poles, units, voids, spikes, regions on a globe. Each file is
//! valid and holds the heights it should.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::common::oracle::Question;
use crate::common::rasters::Raster;
use crate::common::{Folder, Value, data};
use gdal::Dataset;

const ELLIPSOID: &str = "--vertical=ellipsoid";

/// Bakes, and validates what was baked.
fn bake(folder: &Folder, sources: &[&Path], options: &[&str]) -> PathBuf {
    let file = folder.path("out.relief");
    let mut arguments: Vec<&OsStr> = ["bake", "--quiet", "--force", "-o"].map(OsStr::new).into();
    arguments.push(file.as_os_str());
    arguments.extend(sources.iter().map(|source| source.as_os_str()));
    arguments.extend(options.iter().map(OsStr::new));
    let run = crate::common::run(&arguments, None);
    assert_eq!(run.code, 0, "{sources:?}: {}", run.stderr);
    let found = relief_bake!("validate", file, "--quiet");
    assert_eq!(found.code, 0, "{sources:?}: {}{}", found.stdout, found.stderr);
    file
}

/// Bakes with both point kernels, validates, and compares with the oracle.
fn agrees(folder: &Folder, source: &Path, options: &[&str], oracle: &[&str]) {
    for kernel in ["nearest", "bilinear"] {
        let file = bake(folder, &[source], &[options, &["--resample", kernel]].concat());
        let agreement = Question::new(source, &[&["--kernel", kernel], oracle].concat(), 8).ask(&file);
        assert!(agreement.holds(), "{}, {kernel}: {agreement:?}", source.display());
    }
}

fn probe(file: &Path, lon: f64, lat: f64) -> Value {
    relief_bake!("probe", file, lon.to_string(), lat.to_string(), "--json").json(0)
}

fn height_m(file: &Path, lon: f64, lat: f64) -> f64 {
    probe(file, lon, lat)["height_m"].as_f64().unwrap()
}

fn inspect(file: &Path) -> Value {
    relief_bake!("inspect", file, "--json").json(0)
}

/// Height in metres by column and row.
type Shape = fn(usize, usize) -> f32;

/// Waves of 3 km with a pattern of single metres.
fn waves(x: usize, y: usize) -> f32 {
    ((x as f32 * 0.11).sin() * 3000.0 + (y as f32 * 0.07).cos() * 800.0).round() + (x * 7 + y * 13) as f32 % 5.0
}

#[test]
fn every_file_of_the_data_is_valid_with_its_defaults() {
    let folder = Folder::new();
    for name in ["moon_dem_halfmetre_dn.tif", "antarctica_epsg3031.tif", "fiji_across_180.tif", "earth_etopo1_6min.tif"]
    {
        let vertical: &[&str] = if name.starts_with("moon") { &[] } else { &["--vertical", "egm96"] };
        bake(&folder, &[&data(name)], vertical);
    }
    for name in ["srtm_n40e040_3s.tif", "sierra_albers_30m.tif", "bathymetry_utm30n_nan_untagged.tif"] {
        bake(&folder, &[&data(name)], &["--m", "14", "--vertical", "egm96"]);
    }
    for name in ["sierra_albers_30m.tif", "lidar_1m_utm15n.tif", "bathymetry_utm30n_nan_untagged.tif"] {
        bake(&folder, &[&data(name)], &["--body", "plane"]);
    }
}

#[test]
fn every_whole_exr_is_valid() {
    let folder = Folder::new();
    let files = [
        ("GrayRampsHorizontal", "Y"),
        ("WavyLinesLatLong", "G"),
        ("comp_piz", "G"),
        ("comp_zip", "R"),
        ("earth_1024_f16_piz", "Y"),
        ("earth_1024_f32_nan_inf", "R"),
        ("earth_1024_f32_zip", "height"),
        ("lineOrder_decreasing", "B"),
        ("multipart.0001", "G"),
        ("v1.7.test.tiled", "G"),
    ];
    for (name, channel) in files {
        let source = data("exr").join(format!("{name}.exr"));
        bake(&folder, &[&source], &["--bounds=-180,-90,180,90", ELLIPSOID, "--m", "8", "--channel", channel]);
    }
}

#[test]
fn both_sides_of_the_antimeridian_are_one() {
    let folder = Folder::new();
    let file = bake(&folder, &[&data("fiji_across_180.tif")], &[ELLIPSOID]);
    for lat in [-23.0, -17.3, -12.1] {
        let east = probe(&file, 180.0, lat);
        assert_eq!((&east["height_m"], &east["filled"]), (&probe(&file, -180.0, lat)["height_m"], &false.into()));
        // A thousandth of a degree on is at most the steepest slope of the source away.
        let off_m = height_m(&file, 179.999, lat) - height_m(&file, -179.999, lat);
        assert!(off_m.abs() < 50.0, "{off_m} m at {lat}");
    }
}

#[test]
fn poles_have_one_height() {
    let folder = Folder::new();
    let file = bake(&folder, &[&data("antarctica_epsg3031.tif")], &[ELLIPSOID]);
    let pole_m = inspect(&file)["south_pole_m"].as_f64().unwrap();
    assert!((pole_m - 2805.0).abs() < 5.0, "{pole_m}");
    let file = bake(&folder, &[&data("earth_etopo1_6min.tif")], &[ELLIPSOID, "--m", "9"]);
    let facts = inspect(&file);
    assert_eq!((&facts["south_pole_m"], &facts["north_pole_m"]), (&(-56.0).into(), &(-4228.0).into()));
    for lon in [-180.0, -90.5, 0.0, 123.456] {
        assert_eq!((height_m(&file, lon, -90.0), height_m(&file, lon, 90.0)), (-56.0, -4228.0));
    }
}

#[test]
fn nan_and_infinity_are_voids() {
    let folder = Folder::new();
    let source = data("exr/earth_1024_f32_nan_inf.exr");
    let options = ["--bounds=-180,-90,180,90", ELLIPSOID, "--channel", "R"];
    agrees(&folder, &source, &options, &["--bounds=-180,-90,180,90", "--channel", "R"]);
    let facts = inspect(&folder.path("out.relief"));
    let (low_m, high_m) = (facts["min_m"].as_f64().unwrap(), facts["max_m"].as_f64().unwrap());
    assert!(low_m >= -10_714.0 && high_m <= 8266.0, "{low_m} to {high_m}");
}

#[test]
fn void_values_of_old_programs() {
    let folder = Folder::new();
    let void = |x: usize, y: usize| (x / 3 + y / 2).is_multiple_of(7);
    let path = folder.path("int.tif");
    Raster::world(512).write(&path, |x, y| if void(x, y) { -32768 } else { waves(x, y) as i16 });
    agrees(&folder, &path, &[ELLIPSOID, "--nodata", "-32768"], &["--nodata", "-32768"]);
    // Untagged, but no height on any body.
    let path = folder.path("float.tif");
    Raster::world(512).write(&path, |x, y| if void(x, y) { -3.402_823_4e38 } else { waves(x, y) });
    agrees(&folder, &path, &[ELLIPSOID], &[]);
    assert!(inspect(&folder.path("out.relief"))["min_m"].as_f64().unwrap() >= -4000.0);
    // Filled with a height, they are still marked.
    let file = bake(&folder, &[&path], &[ELLIPSOID, "--fill", "-77", "--resample", "nearest"]);
    // The node between columns 18 and 19, rows 2 and 3: x / 3 + y / 2 is 7 for all four.
    let answer = probe(&file, -180.0 + 0.703_125 * 19.0, 90.0 - 0.703_125 * 3.0);
    assert_eq!((&answer["height_m"], &answer["filled"]), (&(-77.0).into(), &true.into()));
    bake(&folder, &[&path], &[ELLIPSOID, "--fill", "interpolate"]);
}

#[test]
fn feet_scale_and_offset() {
    let folder = Folder::new();
    let path = folder.path("feet.tif");
    Raster::world(512).write(&path, waves);
    agrees(&folder, &path, &[ELLIPSOID, "--unit", "ft"], &["--unit", "ft"]);
    agrees(&folder, &path, &[ELLIPSOID, "--unit", "us-ft", "--scale", "2.5"], &["--unit", "us-ft", "--scale", "2.5"]);
    let vrt = folder.path("feet.vrt");
    let text = r#"<VRTDataset rasterXSize="512" rasterYSize="256"><SRS>EPSG:4326</SRS>
        <GeoTransform>-180,0.703125,0,90,0,-0.703125</GeoTransform>
        <VRTRasterBand dataType="Float32" band="1"><UnitType>ft</UnitType>
        <SimpleSource><SourceFilename relativeToVRT="1">feet.tif</SourceFilename></SimpleSource>
        </VRTRasterBand></VRTDataset>"#;
    std::fs::write(&vrt, text).unwrap();
    agrees(&folder, &vrt, &[ELLIPSOID], &[]);
    let path = folder.path("scaled.tif");
    Raster { scale_offset: Some((0.25, 1000.0)), ..Raster::world(512) }.write(&path, |x, y| waves(x, y) as i16);
    agrees(&folder, &path, &[ELLIPSOID], &[]);
}

#[test]
fn south_up_and_turned() {
    let folder = Folder::new();
    let path = folder.path("south_up.tif");
    let step_deg = 360.0 / 512.0;
    Raster { transform: Some([-180.0, step_deg, 0.0, -90.0, 0.0, step_deg]), ..Raster::world(512) }.write(&path, waves);
    agrees(&folder, &path, &[ELLIPSOID], &[]);
    let path = folder.path("turned.tif");
    Raster { transform: Some([10.0, 0.3, 0.1, 40.0, 0.1, -0.3]), size: (150, 120), ..Raster::world(512) }
        .write(&path, waves);
    agrees(&folder, &path, &[ELLIPSOID, "--m", "10"], &[]);
}

#[test]
fn shapes_that_break_bounds() {
    let folder = Folder::new();
    let shapes: [(&str, Shape); 5] = [
        ("flat", |_, _| 42.0),
        ("deep", |x, y| -11_000.0 + waves(x, y) / 100.0),
        ("spikes", |x, y| if x % 97 == 13 && y % 53 == 7 { 9000.0 } else { 0.0 }),
        ("checkerboard", |x, y| if (x + y) % 2 == 0 { 9000.0 } else { -11_000.0 }),
        ("noise", |x, y| ((x * 7919 + y * 104_729) % 20_011) as f32 - 11_000.0),
    ];
    for (name, shape) in shapes {
        let path = folder.path(&format!("{name}.tif"));
        Raster::world(512).write(&path, shape);
        agrees(&folder, &path, &[ELLIPSOID], &[]);
        let path = folder.path(&format!("{name}_plane.tif"));
        Raster::utm((300, 200)).write(&path, shape);
        agrees(&folder, &path, &["--body", "plane"], &[]);
    }
}

/// On a plane every pixel is a node: a spike keeps its height and its neighbours theirs.
#[test]
fn a_spike_is_one_node_of_a_plane() {
    let folder = Folder::new();
    let path = folder.path("spike.tif");
    Raster::utm((64, 64)).write(&path, |x, y| if (x, y) == (20, 30) { 9000f32 } else { 0.0 });
    let file = bake(&folder, &[&path], &["--body", "plane"]);
    let at = |x: f64, y: f64| height_m(&file, 500_000.0 + 30.0 * (x + 0.5), 5_000_000.0 - 30.0 * (y + 0.5));
    assert_eq!([at(20.0, 30.0), at(20.5, 30.0), at(21.0, 30.0), at(20.0, 29.0)], [9000.0, 4500.0, 0.0, 0.0]);
}

#[test]
fn a_body_with_relief_of_a_fifth_of_its_radius() {
    let folder = Folder::new();
    let path = folder.path("rock.tif");
    Raster { epsg: 0, ..Raster::world(512) }.write(&path, |x, y| waves(x, y) * 12.0);
    bake(&folder, &[&path], &["--body", "230000,210000"]);
}

/// Pixels of a raster by longitude and latitude.
struct Pixels {
    width: usize,
    transform: [f64; 6],
    values: Vec<f64>,
}

impl Pixels {
    fn read(path: &Path) -> Self {
        let file = Dataset::open(path).unwrap();
        let (width, _) = file.raster_size();
        let band = file.rasterband(1).unwrap();
        let values = band.read_band_as::<f64>().unwrap().data().to_vec();
        Self { width, transform: file.geo_transform().unwrap(), values }
    }

    /// Lowest and highest pixel within two of a place.
    fn range_m(&self, lon: f64, lat: f64) -> (f64, f64) {
        let [west, dx, _, north, _, dy] = self.transform;
        let (x, y) = (((lon - west) / dx) as usize, ((lat - north) / dy) as usize);
        let near = (y - 2..=y + 2).flat_map(|y| (x - 2..=x + 2).map(move |x| self.values[y * self.width + x]));
        near.fold((f64::MAX, f64::MIN), |(low, high), h| (low.min(h), high.max(h)))
    }

    /// True where the file's height lies between the pixels around, give or take half a step.
    fn explains(&self, file: &Path, lon: f64, lat: f64) -> bool {
        let ((low_m, high_m), height_m) = (self.range_m(lon, lat), height_m(file, lon, lat));
        low_m - 0.5 <= height_m && height_m <= high_m + 0.5
    }
}

#[test]
fn a_fine_region_on_a_coarse_globe() {
    let folder = Folder::new();
    let earth = Pixels::read(&data("earth_etopo1_6min.tif"));
    let coarse = folder.path("coarse.tif");
    // Every tenth sample: a pixel of a degree is centred on the half degree, at column 10 x + 5.
    let pick = |x: usize, y: usize| earth.values[(10 * y + 5) * earth.width + 10 * x + 5] as i16;
    Raster { transform: Some([0.0, 1.0, 0.0, 90.0, 0.0, -1.0]), ..Raster::world(360) }.write(&coarse, pick);
    let (globe, region) = (Pixels::read(&coarse), data("srtm_n40e040_3s.tif"));
    let fine = Pixels::read(&region);
    let [west, dx, _, north, _, dy] = fine.transform;
    let inside = [(300.5, 200.5), (500.2, 500.9), (700.7, 123.4), (77.7, 888.8)];
    let inside = inside.map(|(x, y)| (west + dx * x, north + dy * y));
    let outside = [(100.5, 30.5), (300.1, -45.7), (38.5, 42.5), (179.9, 0.3), (222.2, 66.6)];
    let options = [ELLIPSOID, "--resample", "bilinear"];

    let file = bake(&folder, &[&coarse, &region], &options);
    let facts = inspect(&file);
    assert_eq!(facts["m"], 18);
    assert!(facts["tiles"].as_u64().unwrap() < 200, "{}", facts["tiles"]);
    for (lon, lat) in inside {
        assert!(fine.explains(&file, lon, lat), "{lon} {lat}: {}", probe(&file, lon, lat));
        assert_eq!(probe(&file, lon, lat)["level"], 0);
    }
    for (lon, lat) in outside {
        assert!(globe.explains(&file, lon, lat), "{lon} {lat}: {}", probe(&file, lon, lat));
    }

    // Named last, the globe wins everywhere.
    let file = bake(&folder, &[&region, &coarse], &options);
    for (lon, lat) in inside.into_iter().chain(outside) {
        assert!(globe.explains(&file, lon, lat), "{lon} {lat}: {}", probe(&file, lon, lat));
    }
    assert!(inside.iter().any(|&(lon, lat)| !fine.explains(&file, lon, lat)), "the orders cannot be told apart");
}
