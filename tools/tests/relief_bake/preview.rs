//! `relief-bake preview` as a user runs it.

use std::path::Path;

use relief_tests::png::decode;

use crate::common::{Folder, Sample, earth, plane};

struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Picture {
    fn read(path: &Path) -> Self {
        let (width, height, 3, pixels) = decode(&std::fs::read(path).unwrap()) else { panic!("not RGB") };
        Self { width: width as usize, height: height as usize, pixels }
    }

    fn at(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels[3 * (y * self.width + x)..][..3].try_into().unwrap()
    }

    fn is_sea(&self, x: usize, y: usize) -> bool {
        let [r, g, b] = self.at(x, y);
        b > g && g > r
    }
}

/// Sea in the quarter of the map west of 0 and south of the equator, land elsewhere.
fn quarter_of_sea() -> Sample {
    Sample {
        q: |grid, i, j| match (i % grid.width(0) < grid.width(0) / 2, j < grid.height(0) / 2, j) {
            (true, true, 1..) => -4000 * 16,
            _ => 300 * 16,
        },
        ..earth(8)
    }
}

#[test]
fn north_is_up_and_east_is_right() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &quarter_of_sea());
    let out = folder.path("a.png");
    let run = relief_bake!("preview", file, "-o", out, "--size", "256");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert!(run.stdout.contains("256 x 128 pixels, mip of level 0, -4000 to 300 m"), "{}", run.stdout);
    let picture = Picture::read(&out);
    assert_eq!((picture.width, picture.height), (256, 128));
    let sea = |x, y| picture.is_sea(x, y);
    assert_eq!([sea(64, 96), sea(192, 96), sea(64, 32), sea(192, 32)], [true, false, false, false]);
    // The shore lies between the nodes at 0 degrees and one node west of it.
    assert_eq!([sea(126, 90), sea(128, 90), sea(30, 66), sea(30, 62)], [true, false, true, false]);
}

#[test]
fn a_window_may_cross_the_antimeridian() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &quarter_of_sea());
    let out = folder.path("a.png");
    let run = relief_bake!("preview", file, "-o", out, "--size", "200", "--window", "170,-30,-150,-10");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let picture = Picture::read(&out);
    assert_eq!((picture.width, picture.height), (200, 100));
    assert_eq!([20, 40, 60, 180].map(|x| picture.is_sea(x, 50)), [false, false, true, true]);
}

#[test]
fn voids_are_grey_and_other_planes_have_colours() {
    let folder = Folder::new();
    let filled = |i: u32, j: u32| (100..150).contains(&i) && (100..150).contains(&j);
    let file = folder.sample("a.relief", &Sample { filled, ..earth(8) });
    let out = folder.path("a.png");
    assert_eq!(relief_bake!("preview", file, "-o", out, "--size", "512", "--plane", "nodes").code, 0);
    let [r, g, b] = Picture::read(&out).at(125, 256 - 125);
    assert!(r.abs_diff(g) < 4 && g.abs_diff(b) < 4, "{r} {g} {b}");
    for plane in ["mip", "hext-min", "hext-max", "deviation", "filled"] {
        let run = relief_bake!("preview", file, "-o", out, "--plane", plane, "--size", "64");
        assert_eq!(run.code, 0, "{plane}: {}", run.stderr);
        let picture = Picture::read(&out);
        let legend = if ["mip", "filled"].contains(&plane) { 0 } else { 34 };
        assert_eq!((picture.width, picture.height), (64, 32 + legend), "{plane}");
    }
}

#[test]
fn planes_have_pictures() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &plane(8));
    let out = folder.path("a.png");
    assert_eq!(relief_bake!("preview", file, "-o", out).code, 0);
    let picture = Picture::read(&out);
    assert_eq!((picture.width, picture.height), (255, 170));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(8));
    let out = folder.path("a.png");
    relief_bake!("preview", file, "-o", out, "--window", "0,10,5,10").refused(&["south 10", "rule:"]);
    relief_bake!("preview", file, "-o", file).refused(&["is no PNG"]);
    relief_bake!("preview", file, "-o", folder.path("none/a.png")).refused(&["none"]);
    relief_bake!("preview", file, "-o", out, "--size", "8192", "--window", "0,-90,0.001,90").refused(&["2^28"]);
    assert_eq!(relief_bake!("preview", file, "-o", out, "--size", "3").code, 2);
    assert_eq!(relief_bake!("preview", file, "-o", out, "--window", "1,2,3").code, 2);
    assert_eq!(folder.names(), ["a.relief"]);
    let local = folder.sample("b.relief", &plane(8));
    relief_bake!("preview", local, "-o", out, "--window", "0,0,10,10").refused(&["overlaps"]);
}
