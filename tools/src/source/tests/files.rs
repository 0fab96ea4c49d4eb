//! Files that are whole, and files that are not.

use std::fs;

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};

use super::*;

const TILED: &[&str] = &["COMPRESS=DEFLATE", "TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=64"];
const STRIPS: &[&str] = &["COMPRESS=LZW", "BLOCKYSIZE=3"];

fn noisy(c: usize, r: usize) -> f32 {
    ((c * 7919 + r * 104_729) % 4001) as f32 - 2000.0
}

fn big(creation: &'static [&'static str]) -> Made {
    let tif =
        Tif { size: (720, 360), transform: Some([-180.0, 0.5, 0.0, 90.0, 0.0, -0.5]), creation, ..Tif::default() };
    made(&tif, noisy)
}

#[test]
fn pixels_read_block_by_block_are_those_read_at_once() {
    let grid = Grid::new(9, false);
    for creation in [TILED, STRIPS] {
        let file = big(creation);
        for resample in [Resample::Auto, Resample::Lanczos, Resample::Average] {
            let whole = open(&file.path, &SourceOptions { resample, ..given() });
            let tight = SourceOptions { resample, memory_bytes: 300_000, threads: 3, ..given() };
            let tight = open(&file.path, &tight);
            for level_at in [0, 1] {
                assert_eq!(bits(&level(&whole, &grid, level_at)), bits(&level(&tight, &grid, level_at)));
            }
            // From many threads at once.
            let parts: Vec<_> = std::thread::scope(|scope| {
                let sample = |y: i64| tight.sample(0, &grid, &window(0, 0, y * 128, 1024, 129)).unwrap();
                let running: Vec<_> = (0..4).map(|y| scope.spawn(move || sample(y))).collect();
                running.into_iter().map(|thread| thread.join().unwrap()).collect()
            });
            let all = bits(&level(&whole, &grid, 0));
            for (y, part) in parts.iter().enumerate() {
                assert_eq!(bits(part), all[y * 128 * 1024..][..129 * 1024]);
            }
        }
    }
}

/// Writes over or cuts away the middle of a file.
fn damage(path: &str, cut: bool) {
    let mut bytes = fs::read(path).unwrap();
    let middle = bytes.len() / 2;
    if cut {
        bytes.truncate(middle);
    } else {
        bytes[middle..middle + 2000].fill(0xff);
    }
    fs::write(path, bytes).unwrap();
}

#[test]
fn damaged_blocks_are_errors_and_never_zeros() {
    let grid = Grid::new(8, false);
    for creation in [TILED, STRIPS] {
        for memory_bytes in [1 << 30, 200_000] {
            let options = SourceOptions { memory_bytes, threads: 2, ..given() };
            let sample = |path: &str| {
                let set = open_sources(&[path.to_owned()], &options)?;
                set.sample(0, &grid, &window(0, 0, 0, 512, 257))
            };
            let file = big(creation);
            assert!(sample(&file.path).is_ok());
            damage(&file.path, false);
            let message = sample(&file.path).unwrap_err().to_string();
            assert!(message.contains("made.tif") && message.contains("could not read"), "{message}");
            let file = big(creation);
            damage(&file.path, true);
            let message = sample(&file.path).unwrap_err().to_string();
            assert!(message.contains("made.tif"), "{message}");
        }
    }
}

#[test]
fn what_is_no_source_is_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    assert!(refusal(&at("missing.tif"), &given()).contains("missing.tif"));
    fs::write(at("empty.tif"), b"").unwrap();
    assert!(refusal(&at("empty.tif"), &given()).contains("0 bytes"));
    fs::write(at("text.tif"), b"not a raster at all").unwrap();
    assert!(refusal(&at("text.tif"), &given()).contains("not a raster"));
    assert!(refusal(folder.path().to_str().unwrap(), &given()).contains("folder"));
    assert!(open_sources(&[], &given()).is_err());
    let bare = Tif { crs: None, transform: None, ..Tif::default() };
    let bare = bare.write(folder.path(), "bare.tif", |_, _| 1_i16);
    assert!(refusal(&bare, &given()).contains("--bounds"));
    let no_crs = Tif { crs: None, ..Tif::default() }.write(folder.path(), "no_crs.tif", |_, _| 1_i16);
    assert!(refusal(&no_crs, &given()).contains("--body earth"));
    let earth = SourceOptions { body: Some(BodyChoice::Earth), ..given() };
    assert_eq!(open(&no_crs, &earth).describe()[0].crs, "given body");
    let metres = Tif { transform: Some([5e5, 30.0, 0.0, 4e6, 0.0, -30.0]), crs: None, ..Tif::default() };
    let metres = metres.write(folder.path(), "metres.tif", |_, _| 1_i16);
    assert!(refusal(&metres, &earth).contains("not degrees"));
    let backwards = SourceOptions { bounds: Some([10.0, 0.0, -10.0, 5.0]), ..given() };
    assert!(refusal(&bare, &backwards).contains("west < east"));
    let whole = SourceOptions { bounds: Some([-180.0, -90.0, 180.0, 90.0]), ..given() };
    assert!(open_sources(std::slice::from_ref(&bare), &whole).is_ok());
    let placed = Tif::default().write(folder.path(), "placed.tif", |_, _| 1_i16);
    assert!(refusal(&placed, &whole).contains("leave --bounds out"));
    let band = SourceOptions { channel: Some("2".into()), ..given() };
    assert!(refusal(&placed, &band).contains("--channel"));
    let moon = Tif { crs: Some("+proj=longlat +R=1737400 +no_defs"), ..Tif::default() };
    let moon = moon.write(folder.path(), "moon.tif", |_, _| 1_i16);
    assert!(open_sources(&[placed.clone(), moon], &given()).err().unwrap().to_string().contains("one body"));
    let void = Tif { nodata: Some(1.0), ..Tif::default() }.write(folder.path(), "void.tif", |_, _| 1_i16);
    let set = open(&void, &given());
    let error = set.sample(0, &Grid::new(8, false), &window(0, 0, 0, 4, 4)).unwrap_err().to_string();
    assert!(error.contains("void.tif") && error.contains("all 648 pixels are void"), "{error}");
}

#[test]
fn records_say_what_was_used() {
    let file = made(&Tif { nodata: Some(-7.0), scale: Some(0.25), ..Tif::default() }, |_, _| 1_i16);
    let record = open(&file.path, &given()).describe().remove(0);
    let hash = blake3::hash(&fs::read(&file.path).unwrap()).to_hex().to_string();
    assert_eq!(record.file, "made.tif");
    assert_eq!(record.blake3, Some(hash));
    assert_eq!(
        (record.driver.as_str(), record.sample_type.as_str(), record.crs.as_str()),
        ("GTiff", "Int16", "EPSG:4326")
    );
    assert_eq!(
        (record.width, record.height, record.scale, record.nodata, record.spacing),
        (36, 18, 0.25, Some(-7.0), 10.0)
    );
    let json = serde_json::to_string(&record).unwrap();
    assert_eq!(serde_json::from_str::<SourceRecord>(&json).unwrap(), record);
}

fn exr_options() -> SourceOptions {
    SourceOptions { bounds: Some([-180.0, -90.0, 180.0, 90.0]), ..given() }
}

/// An EXR of 36 x 18 pixels with these channels.
fn exr(folder: &Path, channels: &[(&'static str, FlatSamples)]) -> String {
    let path = folder.join("made.exr");
    let list = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone())).collect();
    let layer = Layer::new((36, 18), LayerAttributes::named("part"), Encoding::FAST_LOSSLESS, AnyChannels::sort(list));
    Image::from_layer(layer).write().to_file(&path).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn exr_channels_are_picked_by_name_and_read_in_all_types() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Grid::new(8, false);
    let f32s = |scale: f32| FlatSamples::F32((0..36 * 18).map(|n| n as f32 * scale).collect());
    let u32s = FlatSamples::U32((0..36 * 18).collect());
    let f16s = FlatSamples::F16((0..36 * 18).map(|n| exr::prelude::f16::from_f32(n as f32)).collect());
    // Pixel 185 (column 5, row 5) is centred at 125 W, 35 N.
    let options = SourceOptions { resample: Resample::Nearest, ..exr_options() };
    let height = |path: &str, options: &SourceOptions| {
        open(path, options).sample(0, &grid, &window(0, 78, 178, 1, 1)).unwrap().height_m[0]
    };
    assert_eq!(height(&exr(folder.path(), &[("height", f32s(2.0)), ("Y", f32s(1.0))]), &options), 370.0);
    assert_eq!(height(&exr(folder.path(), &[("Z", u32s.clone()), ("alpha", f32s(1.0))]), &options), 185.0);
    assert_eq!(height(&exr(folder.path(), &[("anything", f16s)]), &options), 185.0);
    let path = exr(folder.path(), &[("R", f32s(3.0)), ("G", u32s)]);
    let message = refusal(&path, &options);
    assert!(message.contains("channels: G, R") && message.contains("--channel"), "{message}");
    let named = |name: &str| SourceOptions { channel: Some(name.into()), ..options.clone() };
    assert_eq!(height(&path, &named("R")), 555.0);
    assert!(refusal(&path, &named("B")).contains("no channel \"B\""));
    let unplaced = SourceOptions { bounds: None, ..named("R") };
    assert!(refusal(&path, &unplaced).contains("--bounds"));
    let node = SourceOptions { registration: Some(Registration::Node), ..named("G") };
    assert_eq!(open(&path, &node).describe()[0].registration, "node");
}

#[test]
fn damaged_exr_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let samples = FlatSamples::F32((0..36 * 18).map(|n| (n * 7919 % 1013) as f32).collect());
    let path = exr(folder.path(), &[("height", samples)]);
    let bytes = fs::read(&path).unwrap();
    let outcome = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let set = open_sources(std::slice::from_ref(&path), &exr_options())?;
        set.sample(0, &Grid::new(8, false), &window(0, 0, 0, 64, 64))
    };
    assert!(outcome(&bytes).is_ok());
    for cut in [0, 3, 40, bytes.len() / 2, bytes.len() - 1] {
        let message = outcome(&bytes[..cut]).unwrap_err().to_string();
        assert!(message.contains("made.exr"), "{message}");
    }
}

#[test]
fn sixteen_bit_png_needs_bounds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.png");
    let file = fs::File::create(&path).unwrap();
    let mut encoder = png::Encoder::new(file, 36, 18);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let samples: Vec<u8> = (0..36 * 18_u16).flat_map(|n| (n * 100).to_be_bytes()).collect();
    encoder.write_header().unwrap().write_image_data(&samples).unwrap();
    let path = path.to_str().unwrap();
    assert!(refusal(path, &given()).contains("--bounds"));
    let set = open(path, &SourceOptions { resample: Resample::Nearest, ..exr_options() });
    let block = set.sample(0, &Grid::new(8, false), &window(0, 78, 178, 1, 1)).unwrap();
    assert_eq!(block.height_m, [18500.0]);
    assert_eq!(set.describe()[0].driver, "PNG");
}
