use std::sync::Arc;

use proptest::prelude::*;
use relief_formats::body::Body;

use super::*;
use relief_tests::sample_file::Sample;

fn planet(body: Body) -> Arc<Planet> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.relief");
    Sample::new(body, 8).write(&path);
    Planet::open(&path).unwrap()
}

fn plane() -> Body {
    Body::Plane { crs_wkt: String::new(), x0: 100.0, y0: 200.0, dx: 10.0, dy: 10.0 }
}

fn near(a: [f32; 4], b: [f64; 3]) -> bool {
    (0..3).all(|k| (f64::from(a[k]) - b[k]).abs() < 1e-6)
}

#[test]
fn axes_follow_heading_pitch_and_roll() {
    let planet = planet(plane());
    let sun = Sun::at(90.0, 0.0).unwrap();
    let camera = Camera::over_plane(&planet, 1380.0, 1480.0, 50.0).unwrap();
    assert_eq!((camera.s, camera.t), (1 << 30, 1 << 30));
    let axes = |heading, pitch, roll| {
        let view = View::new(camera.looking(heading, pitch, roll), [200, 100], sun).uniform(&planet).unwrap();
        [view.right, view.up, view.forward]
    };
    let expect = |axes: [[f32; 4]; 3], right, up, forward| {
        assert!(near(axes[0], right) && near(axes[1], up) && near(axes[2], forward), "{axes:?}");
    };
    expect(axes(0.0, -90.0, 0.0), [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    expect(axes(90.0, 0.0, 0.0), [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    // Right wing down: right sinks.
    expect(axes(0.0, 0.0, 90.0), [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let view = View::new(camera, [200, 100], sun).uniform(&planet).unwrap();
    assert!(near(view.sun, [1.0, 0.0, 0.0]));
    assert!((view.tan_y - 30f32.to_radians().tan()).abs() < 1e-6 && (view.tan_x - 2.0 * view.tan_y).abs() < 1e-6);
    assert!((view.right[3] - 50.0 / view.tan_y).abs() < 1e-4);
}

proptest! {
    /// The ray of a pixel from the axes of the whole picture, against the one of its own camera.
    #[test]
    fn a_camera_looks_through_a_pixel(
        heading in -400.0f64..400.0, pitch in -90.0f64..90.0, roll in -180.0f64..180.0, fov in 1.0f64..150.0,
        x in 0.0f64..300.0, y in 0.0f64..200.0,
    ) {
        let planet = planet(plane());
        let sun = Sun::at(90.0, 10.0).unwrap();
        let camera = Camera::over_plane(&planet, 1380.0, 1480.0, 50.0).unwrap().looking(heading, pitch, roll).with_fov(fov);
        let whole = View::new(camera, [300, 200], sun).uniform(&planet).unwrap();
        let one = View::new(camera.through([300, 200], [x, y]), [1, 1], sun).uniform(&planet).unwrap();
        let right = f64::from(whole.tan_x) * (x / 150.0 - 1.0);
        let up = f64::from(whole.tan_y) * (1.0 - y / 100.0);
        let ray: [f64; 3] = std::array::from_fn(|k| {
            f64::from(whole.forward[k]) + right * f64::from(whole.right[k]) + up * f64::from(whole.up[k])
        });
        let length = ray[0].hypot(ray[1]).hypot(ray[2]);
        prop_assert!((0..3).all(|k| (ray[k] / length - f64::from(one.forward[k])).abs() < 1e-6), "{:?} {:?}", ray, one.forward);
        // As wide as the pixel looks from the camera.
        let side = 2.0 * f64::from(whole.tan_y) / 200.0 / length;
        prop_assert!((2.0 * f64::from(one.tan_y) / side - 1.0).abs() < 1e-3 || one.tan_y < 2e-5);
    }
}

#[test]
fn the_sun_stands_in_the_zenith_of_its_place() {
    let planet = planet(Body::earth());
    let camera = Camera::over_globe(-171.5, 40.0, 1000.0).unwrap();
    let view = View::new(camera, [10, 10], Sun::over(-171.5, 40.0).unwrap()).uniform(&planet).unwrap();
    // Straight down is away from it.
    assert!((0..3).all(|k| (view.sun[k] + view.forward[k]).abs() < 1e-6), "{view:?}");
    let east = View::new(camera, [10, 10], Sun::over(-81.5, 0.0).unwrap()).uniform(&planet).unwrap();
    assert!(near(east.sun, [0.0, 1.0, 0.0]));
}

#[test]
fn the_sun_has_azimuth_and_elevation() {
    use relief_formats::geodesy::{s_from_lon_deg, t_from_lat_deg};
    let at = |lon: f64, lat: f64| [s_from_lon_deg(lon).unwrap(), t_from_lat_deg(lat).unwrap()];
    let near = |found: [f64; 2], expected: [f64; 2]| (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-6);
    // At an equinox: in the east at sunrise, 90 degrees less the latitude high at noon.
    let sun = Sun::over(0.0, 0.0).unwrap();
    assert!(near(sun.azimuth_elevation_deg(at(-90.0, 0.0)), [90.0, 0.0]));
    assert!(near(sun.azimuth_elevation_deg(at(90.0, 0.0)), [270.0, 0.0]));
    assert!(near(sun.azimuth_elevation_deg(at(0.0, 50.0)), [180.0, 40.0]));
    assert!(near(sun.azimuth_elevation_deg(at(0.0, -50.0)), [0.0, 40.0]));
    assert!(sun.azimuth_elevation_deg(at(180.0, 0.0))[1] < -89.9);
    assert!(near(Sun::at(300.0, 12.5).unwrap().azimuth_elevation_deg([5, 6]), [300.0, 12.5]));
}

#[test]
fn what_shows_nothing_is_refused() {
    let (globe, plane) = (planet(Body::earth()), planet(plane()));
    let sun = Sun::over(0.0, 0.0).unwrap();
    let good = View::new(Camera::over_globe(0.0, 0.0, 1e5).unwrap(), [8, 8], sun);
    assert!(good.uniform(&globe).is_ok());
    assert!(matches!(good.uniform(&plane), Err(ViewError::Body { .. })));
    let broken: [fn(&mut View); 12] = [
        |v| v.width = 0,
        |v| v.height = 0,
        |v| v.pixel_error = f32::NAN,
        |v| v.pixel_error = 0.0,
        |v| v.sun_radius_deg = f64::NAN,
        |v| v.camera.height_m = f64::NAN,
        |v| v.camera.height_m = f64::INFINITY,
        |v| v.camera.heading_deg = f64::NAN,
        |v| v.camera.pitch_deg = -91.0,
        |v| v.camera.fov_deg = 180.0,
        |v| v.camera.t = u32::MAX,
        |v| v.sun = Sun::Ecef([f64::NAN, 0.0, 1.0]),
    ];
    for (n, breaking) in broken.iter().enumerate() {
        let mut view = good;
        breaking(&mut view);
        assert!(view.uniform(&globe).is_err(), "{n}");
    }
    assert!(Camera::over_globe(f64::NAN, 0.0, 0.0).is_err() && Camera::over_globe(0.0, 91.0, 0.0).is_err());
    assert!(Sun::over(f64::NAN, 0.0).is_err() && Sun::at(0.0, 91.0).is_err());
    assert!(Camera::over_plane(&plane, 0.0, 300.0, 1.0).is_err());
    assert!(Camera::over_plane(&globe, 0.0, 0.0, 1.0).is_err());
}

proptest! {
    #[test]
    fn axes_are_right_handed_and_the_kernels_place_the_camera(
        lon in -180.0..180.0f64, lat in -90.0..=90.0f64, height in -500.0..1e7f64,
        heading in -360.0..360.0f64, pitch in -90.0..=90.0f64, roll in -180.0..180.0f64,
    ) {
        thread_local!(static EARTH: Arc<Planet> = planet(Body::earth()));
        let planet = EARTH.with(Arc::clone);
        let camera = Camera::over_globe(lon, lat, height).unwrap().looking(heading, pitch, roll);
        let view = View::new(camera, [64, 48], Sun::over(0.0, 0.0).unwrap()).uniform(&planet).unwrap();
        let [r, u, f] = [view.right, view.up, view.forward].map(|v| [v[0], v[1], v[2]].map(f64::from));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = [r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]];
        prop_assert!((dot(r, r) - 1.0).abs() < 1e-6 && dot(r, f).abs() < 1e-6);
        prop_assert!((dot(cross, u) - 1.0).abs() < 1e-6, "up is right x forward");
        prop_assert!((f64::from(view.camera_h_hi_m) + f64::from(view.camera_h_lo_m) - height).abs() < 1e-7);
        // The camera's own place, in its frame, is the origin.
        let at = relief_shaders::position::camera_relative_m(
            &planet.uniform(), &view, camera.s, camera.t, camera.height_m as f32);
        prop_assert!(at.iter().all(|m| m.abs() < 0.6), "{at:?}");
    }
}
