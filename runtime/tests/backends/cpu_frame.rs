//! What a frame of the twins shows, against rays and heights in f64.

use std::time::Duration;

use relief_formats::body::Body;
use relief_formats::geodesy::{Ellipsoid, lat_deg, lon_deg};
use relief_formats::grid::Grid;
use relief_formats::surface::{Place, Surface};
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::{Frame, Renderer, Settings, Shadow};
use relief_runtime::planet::Planet;
use relief_runtime::view::{Camera, Sun, View};
use relief_tests::sample_file::Sample;

const SIZE: [u32; 2] = [160, 120];

/// Pixels by which what a frame says is off: the point at its distance from the surface, along
/// the normal, and from the place it names.
struct Worst {
    height_px: f64,
    place_px: f64,
    ground: usize,
}

/// The camera's ECEF position and axes (right, up, forward), from the definition of heading and pitch.
pub fn pose(camera: &Camera, body: Ellipsoid) -> ([f64; 3], [[f64; 3]; 3]) {
    let (lon, lat) = (lon_deg(camera.s).to_radians(), lat_deg(camera.t).to_radians());
    let east = [-lon.sin(), lon.cos(), 0.0];
    let north = [-lat.sin() * lon.cos(), -lat.sin() * lon.sin(), lat.cos()];
    let zenith = [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()];
    let (h, p) = (camera.heading_deg.to_radians(), camera.pitch_deg.to_radians());
    let mix = |a: f64, b: f64, c: f64| [0, 1, 2].map(|k| a * east[k] + b * north[k] + c * zenith[k]);
    let axes = [
        mix(h.cos(), -h.sin(), 0.0),
        mix(-h.sin() * p.sin(), -h.cos() * p.sin(), p.cos()),
        mix(h.sin() * p.cos(), h.cos() * p.cos(), p.sin()),
    ];
    (body.ecef_from_fixed_m(camera.s, camera.t, camera.height_m), axes)
}

fn worst(planet: &Planet, view: &View, frame: &Frame) -> Worst {
    let body = planet.ellipsoid().unwrap();
    let surface = Surface::new(planet.relief(), 1 << 26);
    let (eye, [right, up, forward]) = pose(&view.camera, body);
    let tan = (view.camera.fov_deg / 2.0).to_radians().tan();
    let focal_px = f64::from(view.height) / 2.0 / tan;
    let mut worst = Worst { height_px: 0.0, place_px: 0.0, ground: 0 };
    for (k, place) in frame.places.as_ref().unwrap().iter().enumerate() {
        if place.level.is_none() {
            continue;
        }
        worst.ground += 1;
        let (column, row) = (k % view.width as usize, k / view.width as usize);
        let x = (column as f64 + 0.5 - f64::from(view.width) / 2.0) / focal_px;
        let y = (f64::from(view.height) / 2.0 - row as f64 - 0.5) / focal_px;
        let distance_m = f64::from(frame.distance_m[k]);
        let along_m = distance_m / (1.0 + x * x + y * y).sqrt();
        let point = [0, 1, 2].map(|i| eye[i] + along_m * (forward[i] + x * right[i] + y * up[i]));
        let found = body.geodetic_from_ecef(point);
        let (lon, lat) = (found.lon_rad.to_degrees(), found.lat_rad.to_degrees());
        let true_m = surface.height_m(&Place::from_deg(planet.grid(), 0, lon, lat).unwrap()).unwrap();
        let pixel_m = distance_m / focal_px;
        worst.height_px = worst.height_px.max((found.height_m - true_m).abs() / pixel_m);
        let named = body.ecef_from_fixed_m(place.s, place.t, found.height_m);
        let off_m = (0..3).map(|i| (named[i] - point[i]).powi(2)).sum::<f64>().sqrt();
        worst.place_px = worst.place_px.max(off_m / pixel_m);
    }
    worst
}

fn views() -> Vec<View> {
    let camera = |lon, lat, height_m, heading, pitch| {
        Camera::over_globe(lon, lat, height_m).unwrap().looking(heading, pitch, 0.0).with_fov(40.0)
    };
    let sun = Sun::over(20.0, 10.0).unwrap();
    [
        camera(12.0, 40.0, 3e5, 130.0, -60.0),
        camera(179.999, -20.0, 8e4, 20.0, -80.0),
        camera(77.0, 89.9, 2e5, 0.0, -75.0),
        camera(-60.0, -5.0, 4e6, 0.0, -90.0),
    ]
    .map(|camera| View::new(camera, SIZE, sun))
    .to_vec()
}

#[test]
fn pixels_show_the_surface_where_they_say() {
    let planet = crate::support::planet(&Sample::new(Body::earth(), 10));
    let mut cpu = Cpu::new(planet.clone(), 200 << 20).unwrap();
    let settings = Settings { places: true, ..Settings::default() };
    for (n, view) in views().iter().enumerate() {
        let frame = cpu.render_until_complete(view, &settings, Duration::from_secs(100)).unwrap();
        assert_eq!(frame.stats.tiles_missing, 0);
        let found = worst(&planet, view, &frame);
        assert_eq!(found.ground, (SIZE[0] * SIZE[1]) as usize);
        // A pixel of error across the line of sight is up to two along the normal at these angles.
        assert!(found.height_px < 2.0 && found.place_px < 2.0, "view {n}: {} {}", found.height_px, found.place_px);
        // The same frame from another camera is not what is there.
        let mut other = *view;
        other.camera.heading_deg += 3.0;
        other.camera.height_m *= 1.03;
        let wrong = worst(&planet, &other, &frame);
        assert!(wrong.height_px > 2.0 && wrong.place_px > 2.0, "view {n}");
    }
}

/// A body with up to 4 km of relief from node to node.
pub fn rough(body: Body, m: u32) -> Sample {
    let q = |grid: Grid, i: u32, j: u32| match j {
        0 => 0,
        j if j == grid.height(0) => 0,
        _ => {
            let i = i % grid.width(0);
            ((i.wrapping_mul(0x9e37_79b1) ^ j.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35) >> 20) as i32
        }
    };
    Sample { step_exponent: 0, q, ..Sample::new(body, m) }
}

#[test]
fn without_time_the_frame_says_what_it_lacks_and_coarser_tiles_stand_in() {
    let planet = crate::support::planet(&rough(Body::earth(), 11));
    let mut cpu = Cpu::new(planet.clone(), 200 << 20).unwrap();
    let settings = Settings { places: true, ..Settings::default() };
    let view = views()[1];
    let hasty = cpu.render_until_complete(&view, &settings, Duration::ZERO).unwrap();
    assert!(hasty.stats.tiles_missing > 0);
    // The ground is there, though not yet as exact.
    assert!(hasty.distance_m.iter().all(|&distance_m| distance_m > 0.0));
    assert!(worst(&planet, &view, &hasty).height_px > 2.0);
    let whole = cpu.render_until_complete(&view, &settings, Duration::from_secs(100)).unwrap();
    assert_eq!(whole.stats.tiles_missing, 0);
    assert!(worst(&planet, &view, &whole).height_px < 2.0);
}

#[test]
fn shadows_darken_and_count_their_rays() {
    let planet = crate::support::planet(&rough(Body::moon(), 10));
    let mut cpu = Cpu::new(planet, 200 << 20).unwrap();
    // The sun low in the east.
    let view = View { sun: Sun::over(97.0, 0.0).unwrap(), ..views()[0] };
    let mut frame = |shadow| {
        let settings = Settings { shadow, ..Settings::default() };
        cpu.render_until_complete(&view, &settings, Duration::from_secs(100)).unwrap()
    };
    let (dark, bright) = (frame(Shadow::Exact), frame(Shadow::None));
    let brightness = |frame: &Frame| frame.colour.iter().map(|c| u64::from(c[1])).sum::<u64>();
    assert!(brightness(&dark) < brightness(&bright));
    let shaded = dark.lit.iter().filter(|&&lit| lit == 0).count();
    assert!(shaded > 100 && shaded < dark.lit.len(), "{shaded}");
    assert!(bright.lit.iter().all(|&lit| lit == 255));
    assert_eq!(dark.stats.fetches.rays, u64::from(SIZE[0] * SIZE[1]));
    assert!(dark.stats.fetches.heights >= 4 * dark.stats.fetches.rays && bright.stats.fetches.rays == 0);
}
