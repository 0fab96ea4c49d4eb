//! What cannot be done is said with value, rule and remedy, on exit code 2, and writes nothing.

use relief_formats::body::Body;
use relief_tests::folder::Folder;
use relief_tests::plane::plane;
use relief_tests::program::Run;
use relief_tests::sample_file::{Sample, wavy_q};

use crate::program::{program, reliefd};

/// Words of the command and words of its message.
type Case = (&'static str, &'static [&'static str]);

const GLOBE: &[Case] = &[
    ("render FILE --camera NaN,0,1000 --out OUT/a.png", &["--camera", "finite"]),
    ("render FILE --camera 0,91,1000 --out OUT/a.png", &["latitude 91", "remedy:"]),
    ("render FILE --camera 0,0,1e30 --out OUT/a.png", &["camera height", "rule:", "remedy:"]),
    ("render FILE --camera 0,0,1000,0,-91 --out OUT/a.png", &["pitch of -91", "remedy:"]),
    ("render FILE --camera 0,0,1000 --fov 0 --out OUT/a.png", &["field of view of 0", "remedy:"]),
    ("render FILE --camera 0,0,1000 --size 0x5 --out OUT/a.png", &["0x5", "WIDTHxHEIGHT"]),
    ("render FILE --camera 0,0,1000 --backend cpu --size 99999x99999 --out OUT/a.png", &["99999 x 99999", "remedy:"]),
    ("render FILE --camera 0,0,1000 --pixel-error 0 --out OUT/a.png", &["pixel error of 0", "remedy:"]),
    ("render FILE --camera 0,0,1000 --pixel-error nan --out OUT/a.png", &["pixel error of NaN", "remedy:"]),
    ("render FILE --camera 0,0,1000 --wait=-1 --out OUT/a.png", &["--wait", "-1"]),
    ("render FILE --camera 0,0,1000 --out OUT/a.jpg", &["a.jpg", "rule:", "remedy: name", "a.png"]),
    ("render FILE --camera 0,0,1000 --out OUT/a.png --mesh OUT/a.obj", &["--mesh", "a.obj", "remedy:"]),
    ("render FILE --camera 0,0,1000 --out OUT/none/a.png --backend cpu --size 8x8", &["none", "create the folder"]),
    ("render FILE --camera 0,0,1000 --out OUT/a.png --sun 0,95", &["sub-solar latitude of 95", "remedy:"]),
    ("render FILE --camera 0,0,1000 --out OUT/a.png --sun 0,9 --time 2026-06-21T00:00:00Z", &["cannot be used with"]),
    (
        "render FILE --camera 0,0,1000 --shadow paper --out OUT/a.png",
        &["shadow kernel `paper`", "over a plane", "--shadow exact"],
    ),
    ("mask FILE -o OUT/a.tif", &["without a sun", "--sun LON,LAT", "remedy:"]),
    ("mask FILE -o OUT/a.tif --time 2026-06-21", &["2026-06-21", "RFC 3339"]),
    ("mask FILE -o OUT/a.tif --time 2016-12-31T23:59:60Z", &["leap seconds", "remedy:"]),
    ("mask FILE -o OUT/a.tif --sun 0,0 --level 3", &["--level 3", "0 (finest) to 1", "remedy:"]),
    ("mask FILE -o OUT/a.tif --sun 0,0 --window 5,5,4,4", &["--window", "south", "remedy:"]),
    ("mask FILE -o OUT/a.tif --sun 0,0 --window 0.01,0.01,0.02,0.02", &["at least one node", "remedy:"]),
    ("mask FILE -o OUT/a.tif --sun 0,0 --air=-1", &["--air -1", "remedy:"]),
    ("render FILE --camera 0,0,1000 --backend cpu --air=-1 --out OUT/a.png", &["density of the air of -1", "remedy:"]),
    ("mask FILE -o OUT/a.bmp --sun 0,0", &["a.bmp", "remedy:"]),
    ("mask FILE -o OUT/a.tif --times 2026-06-21T00:00:00Z,2026-06-20T00:00:00Z,1h", &["must not lie before"]),
    ("probe FILE 5", &["5 alone", "remedy:"]),
    ("probe FILE 5 95 --backend cpu", &["latitude 95", "rule:", "remedy:"]),
    ("probe FILE 5 x --backend cpu", &["\"x\" is no number", "remedy:"]),
    ("probe FILE 5 5 --level 9 --backend cpu", &["--level 9", "remedy:"]),
    ("report FILE -o OUT/globe.relief --quiet", &["globe.relief", "remedy:"]),
];

const PLANE: &[Case] = &[
    ("render FILE --camera 0,0,1000 --out OUT/a.png", &["easting of 0", "remedy:"]),
    ("mask FILE -o OUT/a.tif", &["without a sun", "--sun AZIMUTH,ELEVATION"]),
    ("mask FILE -o OUT/a.tif --time 2026-06-21T00:00:00Z", &["--time for a plane", "--sun AZIMUTH,ELEVATION"]),
    ("mask FILE -o OUT/a.tif --sun 10,95", &["elevation of 95", "remedy:"]),
    ("mask FILE -o OUT/a.tif --sun 10,5 --window 0,0,10,10", &["--window", "remedy:"]),
    ("probe FILE 0 0 --backend cpu", &["X 0", "remedy:"]),
];

const MOON: &[Case] =
    &[("mask FILE -o OUT/a.tif --time 2026-06-21T00:00:00Z", &["--time for the body moon", "--sun LON,LAT"])];

#[test]
fn what_cannot_be_done_is_said() {
    let folder = Folder::new();
    let globe = folder.sample("globe.relief", &Sample::new(Body::earth(), 9));
    let plane = folder.sample("plane.relief", &plane(wavy_q));
    let moon = folder.sample("moon.relief", &Sample::new(Body::moon(), 8));
    let before = folder.names();
    for (file, cases) in [(globe, GLOBE), (plane, PLANE), (moon, MOON)] {
        for &(words, message) in cases {
            let run = reliefd(words, &file);
            assert_eq!(run.code, 2, "{words}: {}{}", run.stdout, run.stderr);
            assert!(run.stdout.is_empty(), "{words}: {}", run.stdout);
            for part in message {
                assert!(run.stderr.contains(part), "{words}: {part:?} is not in: {}", run.stderr);
            }
            assert_eq!(folder.names(), before, "{words}");
        }
    }
}

#[test]
fn files_that_are_none_are_named() {
    let folder = Folder::new();
    let good = folder.sample("good.relief", &Sample::new(Body::moon(), 8));
    let bytes = std::fs::read(&good).unwrap();
    let mut wrong = bytes.clone();
    wrong[0] ^= 1;
    // Among the first tile's nodes: found when they are decoded.
    let mut damaged = bytes.clone();
    damaged[bytes.len() / 3..][..64].fill(0x5a);
    let cases = [
        ("missing", None),
        ("empty", Some(Vec::new())),
        ("magic", Some(wrong)),
        ("cut", Some(bytes[..bytes.len() / 2].to_vec())),
        ("damaged", Some(damaged)),
    ];
    for (name, bytes) in cases {
        let file = folder.path(&format!("{name}.relief"));
        bytes.into_iter().for_each(|bytes| std::fs::write(&file, bytes).unwrap());
        for words in [
            "render FILE --backend cpu --camera 0,0,1e6 --size 8x8 --out OUT/a.png",
            "mask FILE --sun 0,0 -o OUT/a.tif",
            "probe FILE 0 0 --backend cpu",
        ] {
            let run = reliefd(words, &file);
            assert_eq!(run.code, 2, "{name}: {words}: {}", run.stderr);
            assert!(run.stderr.contains(name) && run.stderr.contains("remedy:"), "{name}: {}", run.stderr);
            assert!(!folder.path("a.png").exists() && !folder.path("a.tif").exists());
        }
    }
}

/// The exit code says it where standard error is closed.
#[test]
fn an_error_that_nobody_reads_is_no_panic() {
    let folder = Folder::new();
    let missing = folder.path("none.relief");
    assert_eq!(Run::unheard(program().arg("probe").arg(missing).args(["0", "0"])), Some(2));
}
