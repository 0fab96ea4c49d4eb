//! What stored values mean: voids, scales, feet, fills, geoids.

use super::*;

/// Pixels at 10, 20, 30 ... with a void in the middle of the raster.
fn with_void(void: f32, nodata: Option<f64>) -> Made {
    let tif = Tif { size: (40, 20), transform: Some([0.0, 1.0, 0.0, 20.0, 0.0, -1.0]), nodata, ..Tif::default() };
    made(&tif, move |c, r| if (18..22).contains(&c) && (8..12).contains(&r) { void } else { 100.0 + c as f32 })
}

#[test]
fn voids_of_all_kinds_are_void_and_never_mixed_in() {
    let grid = Grid::new(10, false);
    let nowhere = (
        f64::from(-32768.0_f32),
        [
            (f32::NAN, None),
            (f32::INFINITY, None),
            (-3.4e38, None),
            (-32768.0, Some(-32768.0)),
            (-9999.9, Some(-9999.9)),
        ],
    );
    for (void, nodata) in nowhere.1 {
        let file = with_void(void, nodata);
        for resample in [Resample::Nearest, Resample::Bilinear, Resample::Cubic, Resample::Lanczos, Resample::Average] {
            let set = open(&file.path, &SourceOptions { resample, ..given() });
            let part = window(0, 1024, 512, 230, 114);
            let block = set.sample(0, &grid, &part).unwrap();
            for (at, (height, state)) in block.height_m.iter().zip(&block.state).enumerate() {
                let lon = grid.lon_deg(0, part.x0 + (at % part.nx) as i64);
                let lat = grid.lat_deg(0, part.y0 + (at / part.nx) as i64);
                // Row 8 lies from 12 down to 11 degrees: rows 8 to 11 from 12 to 8, south edge out.
                let void = (18.0..22.0).contains(&lon) && lat > 8.0 && lat <= 12.0;
                let outside = lat > 20.0 || lon > 40.0;
                assert_eq!(*state, if void || outside { VOID } else { DATA }, "{resample:?} {lon} {lat}");
                if *state == DATA {
                    let expected = 100.0 + (lon - 0.5).clamp(0.0, 39.0);
                    let slack = if matches!(resample, Resample::Lanczos) { 0.6 } else { 1.01 };
                    assert!((f64::from(*height) - expected).abs() < slack, "{resample:?} {lon} {lat}: {height}");
                }
            }
        }
    }
    // -32768 is a height unless somebody says it is not.
    let file = with_void(-32768.0, None);
    let at = window(0, 1024 + 114, 512 + 57, 1, 1);
    assert_eq!(open(&file.path, &given()).sample(0, &grid, &at).unwrap().height_m, [-32768.0]);
    let told = SourceOptions { nodata: Some(-32768.0), ..given() };
    assert_eq!(open(&file.path, &told).sample(0, &grid, &at).unwrap().state, [VOID]);
}

#[test]
fn bilinear_beside_a_void_gives_its_weight_to_the_others() {
    let grid = Grid::new(10, false);
    let file = with_void(f32::NAN, None);
    let set = open(&file.path, &SourceOptions { resample: Resample::Cubic, ..given() });
    // 17.93 E: between column 17 and void column 18, rows all equal.
    let block = set.sample(0, &grid, &window(0, 1024 + 102, 512 + 57, 1, 1)).unwrap();
    assert_eq!((block.height_m[0], block.state[0]), (117.0, DATA));
}

#[test]
fn interpolated_fills_are_smooth_marked_and_leave_data_alone() {
    let grid = Grid::new(10, false);
    let file = with_void(f32::NAN, None);
    let part = window(0, 1024, 512, 230, 116);
    let bare = open(&file.path, &given()).sample(0, &grid, &part).unwrap();
    let filled =
        open(&file.path, &SourceOptions { fill: Fill::Interpolate, ..given() }).sample(0, &grid, &part).unwrap();
    let mut count = 0;
    for at in 0..bare.state.len() {
        match (bare.state[at], filled.state[at]) {
            (DATA, DATA) => assert_eq!(bare.height_m[at].to_bits(), filled.height_m[at].to_bits()),
            (VOID, FILLED) => {
                count += 1;
                assert!((115.0..125.0).contains(&filled.height_m[at]), "{}", filled.height_m[at]);
            }
            (VOID, VOID) => {}
            other => panic!("{other:?}"),
        }
    }
    assert!(count > 400, "{count}");
    let small = SourceOptions { fill: Fill::Interpolate, memory_bytes: 1000, ..given() };
    assert!(refusal(&file.path, &small).contains("--memory"));
}

#[test]
fn feet_scales_and_offsets() {
    let grid = Grid::new(8, false);
    let tif = Tif { scale: Some(0.5), offset: Some(100.0), ..Tif::default() };
    let file = made(&tif, |_, _| 10_i16);
    let height = |options: &SourceOptions| {
        open(&file.path, options).sample(0, &grid, &window(0, 3, 100, 1, 1)).unwrap().height_m[0]
    };
    assert_eq!(height(&given()), 105.0);
    assert_eq!(height(&SourceOptions { unit: Some(Unit::Ft), ..given() }), (105.0 * 0.3048) as f32);
    assert_eq!(height(&SourceOptions { scale: Some(2.0), offset: Some(0.0), ..given() }), 20.0);
    assert_eq!(open(&file.path, &given()).native_step_m(), Some(0.5));
    // NAVD88 in US survey feet: the CRS says the unit.
    let tif = Tif { crs: Some("EPSG:4326+6360"), ..Tif::default() };
    let file = made(&tif, |_, _| 3937_i16);
    let set = open(&file.path, &given());
    assert_eq!(set.sample(0, &grid, &window(0, 3, 100, 1, 1)).unwrap().height_m, [1200.0]);
}

#[test]
fn geoid_is_added_once_and_recorded() {
    let grid = Grid::new(9, false);
    let file = made(&Tif::default(), |_, _| 1000_i16);
    let set = open(&file.path, &SourceOptions { vertical: Some(Vertical::Egm96), ..SourceOptions::default() });
    let record = &set.describe()[0];
    assert_eq!((record.vertical.as_str(), record.geoid_blake3.as_ref().map(String::len)), ("egm96_15.gtx", Some(64)));
    assert_eq!(set.native_step_m(), None);
    let block = level(&set, &grid, 0);
    let at = |lon: f64, lat: f64| {
        let (i, j) = ((lon + 180.0) / 360.0 * 1024.0, (lat + 90.0) / 180.0 * 512.0);
        f64::from(block.height_m[j as usize * 1024 + i as usize]) - 1000.0
    };
    // NGA's published extremes of EGM96 are -107 m south of India and +85 m at New Guinea; its
    // poles are +13.61 m and -29.53 m.
    let (low, high) =
        (0..1024 * 513).fold((f32::MAX, f32::MIN), |(a, b), n| (a.min(block.height_m[n]), b.max(block.height_m[n])));
    assert!((low - 893.0).abs() < 0.6 && (high - 1085.4).abs() < 0.6, "{low} {high}");
    assert!((at(0.0, 90.0) - 13.606).abs() < 0.01 && (at(0.0, -90.0) + 29.534).abs() < 0.01);
    assert!((at(0.0, 0.0) - 17.16).abs() < 0.1, "{}", at(0.0, 0.0));
    let poles = [&block.height_m[..1024], &block.height_m[512 * 1024..]];
    assert!(poles.iter().all(|row| { row.iter().all(|height| height.to_bits() == row[0].to_bits()) }));
}

#[test]
fn vertical_references_must_be_known_on_earth() {
    let plain = SourceOptions::default();
    let file = made(&Tif::default(), |_, _| 1_i16);
    assert!(refusal(&file.path, &plain).contains("--vertical egm96"));
    let navd = made(&Tif { crs: Some("EPSG:4326+5703"), ..Tif::default() }, |_, _| 1_i16);
    assert!(refusal(&navd.path, &plain).contains("NAVD88"));
    let egm96 = made(&Tif { crs: Some("EPSG:4326+5773"), ..Tif::default() }, |_, _| 1_i16);
    assert_eq!(open(&egm96.path, &plain).describe()[0].vertical, "egm96_15.gtx");
    let ellipsoid = made(&Tif { crs: Some("EPSG:4979"), ..Tif::default() }, |_, _| 1_i16);
    assert_eq!(open(&ellipsoid.path, &plain).describe()[0].vertical, "ellipsoid");
    let moon = made(&Tif { crs: Some("+proj=longlat +R=1737400 +no_defs"), ..Tif::default() }, |_, _| 1_i16);
    let set = open(&moon.path, &plain);
    assert_eq!((set.body, set.sources[0].record.vertical.as_str()), (Body::moon(), "as-given"));
    let egm = SourceOptions { vertical: Some(Vertical::Egm96), ..SourceOptions::default() };
    assert!(refusal(&moon.path, &egm).contains("on Earth"));
    let missing = SourceOptions { vertical: Some(Vertical::Gtx("no_such.gtx".into())), ..SourceOptions::default() };
    assert!(refusal(&file.path, &missing).contains("no_such.gtx"));
}
