//! What the overlays say, against the drawn triangles and the file's heights in f64.

use std::sync::Arc;
use std::time::Duration;

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_formats::surface::{Place, Surface};
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::{Frame, Overlay, ReliefTriangle, Renderer, Scheme, Settings, Shadow};
use relief_runtime::gpu::Gpu;
use relief_runtime::planet::Planet;
use relief_runtime::view::{Camera, Sun, View};
use relief_shaders::frame::light::to_srgb;
use relief_shaders::frame::overlay::error_colour;
use relief_tests::sample_file::Sample;

use crate::cpu_frame::{pose, rough};

const LONG: Duration = Duration::from_secs(100);
const SIZE: [u32; 2] = [160, 120];
const ATLAS_BYTES: u64 = 200 << 20;

fn backends(planet: &Arc<Planet>) -> Vec<Box<dyn Renderer>> {
    let mut backends: Vec<Box<dyn Renderer>> = vec![Box::new(Cpu::new(Arc::clone(planet), ATLAS_BYTES).unwrap())];
    if let Some(device) = crate::support::device() {
        backends.push(Box::new(Gpu::new(&device, Arc::clone(planet), ATLAS_BYTES).unwrap()));
    }
    backends
}

fn over_globe(lon: f64, lat: f64, height_m: f64, heading: f64, pitch: f64) -> View {
    let camera = Camera::over_globe(lon, lat, height_m).unwrap().looking(heading, pitch, 0.0).with_fov(40.0);
    // High above the camera: level ground has nearly its full colour.
    View::new(camera, SIZE, Sun::over(lon, lat).unwrap())
}

fn of(overlay: Overlay, scheme: Scheme) -> Settings {
    Settings { overlay, scheme, shadow: Shadow::None, ..Settings::default() }
}

/// The share of the threshold that a colour stands for, and the relief's light upon it.
fn share_of([red, green, blue, _]: [u8; 4]) -> f64 {
    let found = [red, green, blue].map(f32::from);
    let mut best = (f32::MAX, 0.0);
    for share in (0..=400u16).map(|k| f32::from(k) / 200.0) {
        let colour = error_colour(share);
        for light in (25..=75u8).map(|k| f32::from(k) / 50.0) {
            let bytes = to_srgb(colour.map(|c| c * light)).map(|c| c * 255.0);
            let off = (0..3).map(|k| (bytes[k] - found[k]).powi(2)).sum();
            if off < best.0 {
                best = (off, share);
            }
        }
    }
    f64::from(best.1)
}

/// Where a ray from the origin first meets a triangle, as a multiple of the ray.
fn meets(ray: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> Option<f64> {
    let minus = |u: [f64; 3], v: [f64; 3]| [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
    let cross =
        |u: [f64; 3], v: [f64; 3]| [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let sides = [dot(ray, cross(a, b)), dot(ray, cross(b, c)), dot(ray, cross(c, a))];
    if !(sides.iter().all(|&v| v >= 0.0) || sides.iter().all(|&v| v <= 0.0)) {
        return None;
    }
    let normal = cross(minus(b, a), minus(c, a));
    let along = dot(a, normal) / dot(ray, normal);
    (along > 0.0).then_some(along)
}

/// Height of the drawn surface above S_0 at a pixel, in pixels of its distance: the pixel's ray
/// against all triangles, the ellipsoid and the file, in f64.
fn error_px(planet: &Planet, surface: &Surface<'_>, view: &View, mesh: &[ReliefTriangle], pixel: [u32; 2]) -> f64 {
    let body = planet.ellipsoid().unwrap();
    let (eye, [right, up, forward]) = pose(&view.camera, body);
    let focal_px = f64::from(view.height) / 2.0 / (view.camera.fov_deg / 2.0).to_radians().tan();
    let x = (f64::from(pixel[0]) + 0.5 - f64::from(view.width) / 2.0) / focal_px;
    let y = (f64::from(view.height) / 2.0 - f64::from(pixel[1]) - 0.5) / focal_px;
    let ray: [f64; 3] = std::array::from_fn(|k| forward[k] + x * right[k] + y * up[k]);
    let along = mesh.iter().filter_map(|triangle| {
        let corners = triangle.map(|c| {
            let at = body.ecef_from_fixed_m(c.s, c.t, f64::from(c.height_m));
            [at[0] - eye[0], at[1] - eye[1], at[2] - eye[2]]
        });
        meets(ray, corners)
    });
    let along = along.min_by(f64::total_cmp).unwrap();
    let drawn = body.geodetic_from_ecef(std::array::from_fn(|k| eye[k] + along * ray[k]));
    let (lon, lat) = (drawn.lon_rad.to_degrees(), drawn.lat_rad.to_degrees());
    let true_m = surface.height_m(&Place::from_deg(planet.grid(), 0, lon, lat).unwrap()).unwrap();
    (drawn.height_m - true_m).abs() * focal_px / (along * (1.0 + x * x + y * y).sqrt())
}

#[test]
fn the_error_is_that_of_the_drawn_triangles() {
    let planet = crate::support::planet(&Sample::new(Body::earth(), 9));
    let surface = Surface::new(planet.relief(), 1 << 26);
    // The flat triangles of the second are wide: most of their error is the planet's own curve.
    let cases = [
        (over_globe(12.0, 40.0, 4e5, 130.0, -60.0), Scheme::Leb, 1.0),
        (View { pixel_error: 6.0, ..over_globe(-60.0, -5.0, 3e6, 0.0, -90.0) }, Scheme::Leb, 6.0),
        (over_globe(179.99, -20.0, 4e5, 20.0, -70.0), Scheme::Paper, 1.0),
        (View { pixel_error: 0.05, ..over_globe(77.0, 60.0, 2e5, 0.0, -75.0) }, Scheme::Uniform { level: 1 }, 0.05),
    ];
    for mut backend in backends(&planet) {
        let mut largest = 0f64;
        for (n, (view, scheme, threshold_px)) in cases.iter().enumerate() {
            let frame = backend.render_until_complete(view, &of(Overlay::Error, *scheme), LONG).unwrap();
            assert_eq!(frame.stats.tiles_missing, 0);
            let mesh = backend.mesh(view, *scheme).unwrap();
            let pixels = (0..48).map(|k| [3 + k % 8 * 21, 4 + k / 8 * 20]);
            let pairs: Vec<[f64; 2]> = pixels
                .map(|[column, row]| {
                    let expected = error_px(&planet, &surface, view, &mesh, [column, row]) / threshold_px;
                    [expected, share_of(frame.colour[(row * SIZE[0] + column) as usize])]
                })
                .collect();
            let apart = |expected: f64, found: f64| (found - expected.min(2.0)).abs() > 0.04;
            // A pixel at a ridge's outline may show the other side of it.
            let away = pairs.iter().filter(|[expected, found]| apart(*expected, *found)).count();
            assert!(away <= 1, "view {n}: {away} of {} pixels", pairs.len());
            // Another pixel's error is not that which is shown.
            let wrong = pairs.windows(2).filter(|pair| apart(pair[0][0], pair[1][1])).count();
            assert!(wrong > 10, "view {n}: {wrong}");
            largest = pairs.iter().fold(largest, |largest, pair| largest.max(pair[0]));
        }
        assert!(largest > 1.2, "some of it is above the threshold: {largest}");
    }
}

/// Ground pixels whose colour says that the error is above the threshold, and that there is one.
fn above(frame: &Frame) -> [usize; 2] {
    let ground = || frame.colour.iter().zip(&frame.distance_m).filter(|(_, distance_m)| **distance_m > 0.0);
    let red = ground().filter(|(colour, _)| colour[0] > colour[2].saturating_add(1)).count();
    [red, ground().filter(|(colour, _)| colour[0] > 90).count()]
}

#[test]
fn bisection_keeps_the_threshold_and_a_uniform_mesh_does_not() {
    let planet = crate::support::planet(&rough(Body::moon(), 10));
    let views = [
        over_globe(12.0, 40.0, 3e5, 130.0, -60.0),
        over_globe(179.999, -20.0, 5e4, 20.0, -20.0),
        over_globe(77.0, 89.9, 2e5, 0.0, -75.0),
        over_globe(100.0, -30.0, 8e3, 200.0, -3.0),
        over_globe(-60.0, -5.0, 3e6, 0.0, -90.0),
    ];
    // Rasterisers of GPUs may snap corners for coverage only: over a wall seen edge-on, thinner than
    // a 256th of a pixel, they then draw a point beside the triangle.
    for (mut backend, most) in backends(&planet).into_iter().zip([0, 2]) {
        for (n, view) in views.iter().enumerate() {
            let mut frame = |scheme, pixel_error| {
                let view = View { pixel_error, ..*view };
                let frame = backend.render_until_complete(&view, &of(Overlay::Error, scheme), LONG).unwrap();
                assert_eq!(frame.stats.tiles_missing, 0);
                above(&frame)
            };
            for pixel_error in [0.5, 1.0, 4.0] {
                let [red, some] = frame(Scheme::Leb, pixel_error);
                assert!(red <= most, "view {n}, {pixel_error} pixels: {red}");
                assert!(some > 100 || n > 0, "view {n}, {pixel_error} pixels: {some}");
            }
            if n < 4 {
                let red = frame(Scheme::Uniform { level: 2 }, 1.0)[0];
                assert!(red > 500, "view {n}: {red}");
            }
        }
    }
}

/// A plane whose level-0 nodes that are not of level 1 stand 64 m high, all others at 0: a mesh of
/// level 1 misses them by just that.
#[test]
fn a_plane_shows_the_error_it_was_given() {
    fn spikes(_: Grid, i: u32, j: u32) -> i32 {
        if i & 1 == 1 && j & 1 == 1 { 64 } else { 0 }
    }
    let body = Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: 100.0, dy: 100.0 };
    let planet = crate::support::planet(&Sample { step_exponent: 0, q: spikes, ..Sample::new(body, 9) });
    let camera = Camera::over_plane(&planet, 25_500.0, 25_500.0, 4000.0).unwrap().looking(0.0, -90.0, 0.0);
    let view = View::new(camera.with_fov(20.0), [121, 121], Sun::at(0.0, 90.0).unwrap());
    let focal_px = 121.0 / 2.0 / 10f64.to_radians().tan();
    let middle = 60 * 121 + 60;
    for mut backend in backends(&planet) {
        for threshold_px in [8.0, 16.0, 32.0] {
            let view = View { pixel_error: threshold_px, ..view };
            let settings = of(Overlay::Error, Scheme::Uniform { level: 1 });
            let frame = backend.render_until_complete(&view, &settings, LONG).unwrap();
            // Under the camera is a spike's tip; the ground that is drawn lies 4000 m off.
            let expected = 64.0 * focal_px / 4000.0 / f64::from(threshold_px);
            let found = share_of(frame.colour[middle]);
            assert!((found - expected).abs() < 0.06, "{threshold_px}: {found} {expected}");
        }
    }
}

/// Mean brightness of the pixels where stripes are dark, over that of the others.
fn stripes(frame: &Frame) -> f64 {
    let mut sums = [[0.0; 2]; 2];
    for (k, colour) in frame.colour.iter().enumerate() {
        let dark = (k as u32 % frame.width + k as u32 / frame.width) % 12 < 4;
        let sum = &mut sums[usize::from(dark)];
        sum[0] += f64::from(colour[0]) + f64::from(colour[1]) + f64::from(colour[2]);
        sum[1] += 1.0;
    }
    (sums[1][0] / sums[1][1]) / (sums[0][0] / sums[0][1])
}

#[test]
fn pages_that_stand_in_are_striped() {
    let planet = crate::support::planet(&rough(Body::earth(), 11));
    let near = over_globe(179.999, -20.0, 8e4, 20.0, -80.0);
    for overlay in [Overlay::Pages, Overlay::Error] {
        for mut backend in backends(&planet) {
            let settings = of(overlay, Scheme::Leb);
            let hasty = backend.render_until_complete(&near, &settings, Duration::ZERO).unwrap();
            assert!(hasty.stats.tiles_missing > 0);
            assert!(stripes(&hasty) < 0.75, "{overlay:?}: {}", stripes(&hasty));
            let whole = backend.render_until_complete(&near, &settings, LONG).unwrap();
            assert_eq!(whole.stats.tiles_missing, 0);
            assert!(stripes(&whole) > 0.97, "{overlay:?}: {}", stripes(&whole));
        }
    }
}

#[test]
fn from_far_away_pages_are_at_hand_but_the_finest_truth_is_not() {
    let planet = crate::support::planet(&Sample::new(Body::earth(), 11));
    let far = over_globe(10.0, 10.0, 3e7, 0.0, -90.0);
    for mut backend in backends(&planet) {
        let mut frame = |overlay| backend.render_until_complete(&far, &of(overlay, Scheme::Leb), LONG).unwrap();
        let (pages, error) = (frame(Overlay::Pages), frame(Overlay::Error));
        assert_eq!((pages.stats.tiles_missing, error.stats.tiles_missing), (0, 0));
        assert!(stripes(&pages) > 0.95 && stripes(&error) < 0.85, "{} {}", stripes(&pages), stripes(&error));
        // Far fewer pages than S_0 has.
        assert!(error.stats.tiles_resident < 100, "{}", error.stats.tiles_resident);
    }
}
