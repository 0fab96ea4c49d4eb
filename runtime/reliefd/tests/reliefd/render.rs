//! Frames and what comes with them.

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_tests::folder::Folder;
use relief_tests::plane::plane;
use relief_tests::sample_file::{Sample, wavy_q};

use crate::mask::wall;
use crate::probe::backends;
use crate::program::{png, reliefd};

#[test]
fn a_frame_its_mask_and_its_figures() {
    let folder = Folder::new();
    let file = folder.sample("earth.relief", &Sample::new(Body::earth(), 9));
    for backend in backends() {
        let words = format!(
            "render FILE --backend {backend} --camera 20,10,300000,30,-25 --fov 50 --size 160x90 --sun 60,10 \
             --out OUT/a.png --mask OUT/m.png --stats"
        );
        let stats = reliefd(&words, &file).json(0);
        assert!(stats["triangles"].as_u64().unwrap() > 10, "{stats}");
        assert_eq!((&stats["tiles_missing"], &stats["holes"]), (&0.into(), &false.into()));
        assert_eq!((&stats["width"], &stats["height"], &stats["scheme"]), (&160.into(), &90.into(), &"leb".into()));
        assert!((1.0..200.0).contains(&stats["fetches_per_ray"].as_f64().unwrap()), "{stats}");
        assert!(stats["pass_ms"].is_object() && stats["complete_ms"].as_f64() > stats["open_ms"].as_f64());
        let (width, height, channels, colours) = png(&folder.path("a.png"));
        assert_eq!((width, height, channels), (160, 90, 3));
        let (.., mask) = png(&folder.path("m.png"));
        assert_eq!(mask.len(), 160 * 90);
        // Sky above, ground below, and the ground is in the light.
        assert!(mask[..160].iter().all(|&lit| lit == 0));
        assert!(mask[160 * 89..].iter().filter(|&&lit| lit == 255).count() > 100);
        assert_ne!(colours[..3], colours[3 * 160 * 89..][..3]);
        let first = std::fs::read(folder.path("a.png")).unwrap();
        reliefd(&words, &file).good();
        assert_eq!(std::fs::read(folder.path("a.png")).unwrap(), first, "{backend}: the same view, the same pixels");
    }
}

/// Without a sun the light is that of maps: from the north-west, wherever the camera is.
#[test]
fn light_comes_from_the_north_west() {
    fn dome(grid: Grid, i: u32, j: u32) -> i32 {
        let away = |v: u32| f64::from(v) - f64::from(grid.height(0)) / 2.0;
        (16.0 * 900.0 - 0.9 * (away(i).powi(2) + away(j).powi(2))).max(0.0) as i32
    }
    let folder = Folder::new();
    let plane = folder.sample("dome.relief", &plane(dome));
    reliefd("render FILE --backend cpu --camera 4840,5840,9000 --size 64x64 --out OUT/a.png", &plane).good();
    let (.., colours) = png(&folder.path("a.png"));
    let brightness = |x: usize, y: usize| -> u32 { (0..3).map(|c| u32::from(colours[3 * (64 * y + x) + c])).sum() };
    assert!(brightness(26, 26) > brightness(38, 38) + 20, "{} {}", brightness(26, 26), brightness(38, 38));
}

#[test]
fn meshes_are_metres_around_the_cameras_foot() {
    let folder = Folder::new();
    let globe = folder.sample("earth.relief", &Sample::new(Body::earth(), 9));
    let plane = folder.sample("plane.relief", &plane(wavy_q));
    for (file, camera) in [(&globe, "179.99,-30,20000"), (&plane, "4840,5840,3000")] {
        let stats = reliefd(
            &format!(
                "render FILE --backend cpu --camera {camera} --size 64x64 --out OUT/a.png --mesh OUT/a.glb --stats"
            ),
            file,
        )
        .json(0);
        let bytes = std::fs::read(folder.path("a.glb")).unwrap();
        let word = |at: usize| u32::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
        let json = &bytes[20..20 + word(12)];
        let document: serde_json::Value = serde_json::from_slice(json).unwrap();
        let accessors = &document["accessors"];
        assert_eq!(accessors[2]["count"].as_u64(), stats["triangles"].as_u64().map(|n| 3 * n));
        let side = |name: &str, k: usize| accessors[0][name][k].as_f64().unwrap();
        for k in 0..3 {
            assert!(side("min", k) < side("max", k));
        }
        // Under the camera, not at the centre of the Earth.
        assert!(side("min", 0) < 0.0 && side("max", 0) > 0.0 && side("min", 2) < 0.0 && side("max", 2) > 0.0);
        assert!(side("max", 1) < 10_000.0 && side("max", 1) > -1000.0, "{}", accessors[0]);
    }
}

#[test]
fn overlays_and_schemes_differ() {
    let folder = Folder::new();
    let file = folder.sample("earth.relief", &Sample::new(Body::earth(), 9));
    let frame = |options: &str| {
        let words = format!("render FILE --backend cpu --camera 20,10,200000 --size 96x64 --out OUT/a.png {options}");
        reliefd(&words, &file).good();
        png(&folder.path("a.png")).3
    };
    let plain = frame("");
    let overlays = ["wireframe", "lod", "pages", "error"].map(|overlay| frame(&format!("--overlay {overlay}")));
    for (k, overlay) in overlays.iter().enumerate() {
        assert!(*overlay != plain && !overlays[..k].contains(overlay), "{k}");
    }
    assert!(plain != frame("--time 2026-06-21T22:00:00Z"), "night");
    assert!(frame("--scheme paper").len() == plain.len());
}

/// A dam of 16 nodes from the wall eastwards.
fn dam(grid: Grid, i: u32, j: u32) -> i32 {
    (0..16).map(|width| wall(grid, i.saturating_sub(width), j)).max().unwrap_or(0)
}

/// West of a wall, with the sun in the east. The paper's kernel sees a dam, but loses a wall of one
/// node between the samples of its bounds.
#[test]
fn shadows_are_drawn_unless_they_are_not_wanted() {
    let folder = Folder::new();
    let lit = |backend: &str, relief: fn(Grid, u32, u32) -> i32, options: &str| {
        let file = folder.sample("wall.relief", &plane(relief));
        let words = format!(
            "render FILE --backend {backend} --camera 6000,5840,9000 --size 64x64 --sun 90,20 --out OUT/a.png --mask OUT/m.png {options}"
        );
        reliefd(&words, &file).good();
        png(&folder.path("m.png")).3[64 * 32 + 32 - 4]
    };
    for backend in backends() {
        let of = |relief| ["", "--shadow paper", "--shadow none"].map(|options| lit(backend, relief, options));
        assert_eq!([of(wall), of(dam)], [[0, 255, 255], [0, 0, 255]], "{backend}");
    }
}
