//! Flat maps.

use super::*;

fn plane() -> SourceOptions {
    SourceOptions { body: Some(BodyChoice::Plane), ..SourceOptions::default() }
}

fn tile(folder: &Path, name: &str, x: f64, y: f64, south_up: bool) -> String {
    let transform = if south_up { [x, 30.0, 0.0, y, 0.0, 30.0] } else { [x, 30.0, 0.0, y + 50.0 * 30.0, 0.0, -30.0] };
    let tif = Tif {
        size: (100, 50),
        transform: Some(transform),
        crs: Some("EPSG:32633"),
        nodata: Some(0.0),
        ..Tif::default()
    };
    // Height = easting + northing of the pixel centre, in pixels.
    tif.write(folder, name, move |c, r| {
        let northing = transform[3] + (r as f64 + 0.5) * transform[5];
        ((x + (c as f64 + 0.5) * 30.0 + northing) / 30.0) as f32
    })
}

#[test]
fn nodes_are_pixels_and_the_rest_is_padding() {
    let folder = tempfile::tempdir().unwrap();
    for south_up in [false, true] {
        let path = tile(folder.path(), "a.tif", 300_000.0, 4_500_000.0, south_up);
        let set = open(&path, &plane());
        assert_eq!(set.default_m(), 8);
        let Body::Plane { crs_wkt, x0, y0, dx, dy } = &set.body else { panic!("not a plane") };
        assert!(crs_wkt.contains("UTM zone 33N"));
        assert_eq!((*x0, *y0, *dx, *dy), (300_015.0, 4_500_015.0, 30.0, 30.0));
        let grid = Grid::new(8, true);
        let block = set.sample(0, &grid, &window(0, 0, 0, 257, 257)).unwrap();
        let expected = |i: usize, j: usize| {
            ((300_015.0 + 30.0 * i.min(99) as f64 + 4_500_015.0 + 30.0 * j.min(49) as f64) / 30.0) as f32
        };
        for (at, height) in block.height_m.iter().enumerate() {
            let (i, j) = (at % 257, at / 257);
            assert_eq!(*height, expected(i, j), "{i} {j}");
            assert_eq!(block.state[at], if i < 100 && j < 50 { DATA } else { FILLED });
        }
        for level in 1..=3_u32 {
            let n = (256 >> level) + 1;
            let coarse = set.sample(0, &grid, &window(level, 0, 0, n, n)).unwrap();
            for (at, height) in coarse.height_m.iter().enumerate() {
                let from = ((at / n) << level) * 257 + ((at % n) << level);
                assert_eq!((height.to_bits(), coarse.state[at]), bits(&block)[from]);
            }
        }
        assert!(set.covers(0, &grid, &window(0, 90, 40, 5, 5)));
    }
}

#[test]
fn several_rasters_make_one_plane_if_they_fit() {
    let folder = tempfile::tempdir().unwrap();
    let a = tile(folder.path(), "a.tif", 300_000.0, 4_500_000.0, false);
    let b = tile(folder.path(), "b.tif", 303_000.0, 4_501_500.0, true);
    let set = open_sources(&[a.clone(), b], &plane()).unwrap();
    let grid = Grid::new(set.default_m(), true);
    let block = set.sample(1, &grid, &window(0, 98, 48, 4, 4)).unwrap();
    assert_eq!(block.state[..8], [VOID; 8]);
    assert_eq!(block.state[8..], [VOID, VOID, DATA, DATA, VOID, VOID, DATA, DATA]);
    assert_eq!(block.height_m[10], ((300_015.0 + 3000.0 + 4_500_015.0 + 1500.0) / 30.0) as f32);
    assert!(!set.covers(1, &grid, &window(0, 0, 0, 90, 40)));
    let off = tile(folder.path(), "off.tif", 303_010.0, 4_500_000.0, false);
    assert!(open_sources(&[a.clone(), off], &plane()).err().unwrap().to_string().contains("gdalwarp -tap"));
    let egm = SourceOptions { vertical: Some(Vertical::Egm96), ..plane() };
    assert!(refusal(&a, &egm).contains("plane"));
    let turned = Tif { transform: Some([0.0, 1.0, 0.1, 0.0, 0.1, -1.0]), crs: Some("EPSG:32633"), ..Tif::default() };
    assert!(refusal(&turned.write(folder.path(), "turned.tif", |_, _| 1_i16), &plane()).contains("rotated"));
}
