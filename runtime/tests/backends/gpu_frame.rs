//! Frames of the GPU against those of the twins.

use std::sync::Arc;
use std::time::Duration;

use relief_formats::body::Body;
use relief_formats::geodesy::lat_deg;
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::RenderError;
use relief_runtime::frame::{Frame, Overlay, Renderer, Scheme, Settings, Shadow};
use relief_runtime::gpu::{Device, DeviceError, Gpu, HostTargets};
use relief_runtime::planet::Planet;
use relief_runtime::view::{Camera, Sun, View, ViewError};
use relief_tests::sample_file::Sample;

const LONG: Duration = Duration::from_secs(100);
/// Of a picture 200 pixels high, 60 degrees.
const FOCAL_PX: f64 = 173.2;
const ATLAS_BYTES: u64 = 100 << 20;

/// Shares of pixels that differ: by more than a quarter of a pixel or by the level in what they
/// show, by more than two of 255 in colour, by more than a thousandth in distance; in the part of
/// the sun that is seen.
#[derive(Clone, Copy, Debug)]
struct Difference {
    places: f64,
    colour: f64,
    distance: f64,
    lit: f64,
}

fn difference(a: &Frame, b: &Frame, focal_px: f64) -> Difference {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let share = |differs: &dyn Fn(usize) -> bool| {
        (0..a.colour.len()).filter(|&k| differs(k)).count() as f64 / a.colour.len() as f64
    };
    let (places_a, places_b) = (a.places.as_ref().unwrap(), b.places.as_ref().unwrap());
    Difference {
        places: share(&|k| {
            let (p, q) = (places_a[k], places_b[k]);
            let unit_m = 9.3e-3;
            let north_m = (i64::from(p.t) - i64::from(q.t)) as f64 * unit_m;
            let cos_lat = (lat_deg(p.t).to_radians()).cos();
            let east_m = f64::from(p.s.wrapping_sub(q.s) as i32) * unit_m * cos_lat;
            p.level != q.level || north_m.hypot(east_m) > 0.25 * f64::from(a.distance_m[k]) / focal_px
        }),
        colour: share(&|k| a.colour[k].iter().zip(b.colour[k]).any(|(&x, y)| x.abs_diff(y) > 2)),
        lit: share(&|k| a.lit[k].abs_diff(b.lit[k]) > 2),
        distance: share(&|k| (a.distance_m[k] - b.distance_m[k]).abs() > 1e-3 * a.distance_m[k].max(b.distance_m[k])),
    }
}

fn gpu(device: &Device, planet: &Arc<Planet>) -> Gpu {
    Gpu::new(device, Arc::clone(planet), ATLAS_BYTES).unwrap()
}

fn views() -> Vec<View> {
    let size = [320, 200];
    let globe = |lon, lat, height_m| Camera::over_globe(lon, lat, height_m).unwrap();
    vec![
        View::new(globe(30.0, 10.0, 9e6), size, Sun::over(60.0, 20.0).unwrap()),
        View::new(globe(-179.9, 45.0, 3e5).looking(80.0, -30.0, 10.0), size, Sun::over(160.0, 0.0).unwrap()),
        View::new(globe(12.0, 89.95, 2e5).looking(0.0, -50.0, 0.0), size, Sun::over(0.0, 23.0).unwrap()),
        View::new(globe(100.0, -30.0, 2e3).looking(200.0, -3.0, 0.0), size, Sun::over(120.0, -10.0).unwrap()),
    ]
}

#[test]
fn the_gpu_draws_what_the_twins_draw() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 10));
    let (mut gpu, mut cpu) = (gpu(&device, &planet), Cpu::new(Arc::clone(&planet), ATLAS_BYTES).unwrap());
    let mut frames = Vec::new();
    let adaptive = Settings { places: true, ..Settings::default() };
    let uniform = Settings { scheme: Scheme::Uniform { level: 2 }, ..adaptive };
    let paper = Settings { scheme: Scheme::Paper, ..adaptive };
    let [marked, pages, error] =
        [Overlay::Detail, Overlay::Pages, Overlay::Error].map(|overlay| Settings { overlay, ..adaptive });
    for (n, view) in views().iter().enumerate() {
        // Marks along sides are a pixel wide, and derivatives of small triangles coarse.
        let smooth = [adaptive, uniform, paper, pages, error].map(|settings| (settings, 1e-3));
        for (settings, colour) in smooth.into_iter().chain([(marked, 2e-2)]) {
            let [a, b] = [&mut gpu as &mut dyn Renderer, &mut cpu]
                .map(|renderer| renderer.render_until_complete(view, &settings, LONG).unwrap());
            assert_eq!((a.stats.tiles_missing, b.stats.tiles_missing), (0, 0));
            assert!(!a.stats.overflow && !b.stats.overflow);
            let apart = difference(&a, &b, FOCAL_PX);
            eprintln!("view {n} {settings:?}: {apart:?}");
            assert!(
                apart.places < 1e-3 && apart.colour < colour && apart.distance < 1e-3 && apart.lit < 1e-3,
                "view {n}: {apart:?}"
            );
            if !matches!(settings.scheme, Scheme::Uniform { .. }) {
                let [a, b] = [&a.stats, &b.stats].map(|s| [s.triangles, s.tested, s.culled, s.fillers]);
                assert_eq!(a, b, "view {n} {settings:?}");
            }
            frames.push(a);
        }
    }
    // The comparison sees a difference where there is one.
    let apart = difference(&frames[0], &frames[6], FOCAL_PX);
    assert!(apart.places > 0.3 && apart.colour > 0.3 && apart.distance > 0.3, "{apart:?}");
}

#[test]
fn both_backends_give_the_same_mesh() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::moon(), 9));
    let (mut gpu, mut cpu) = (gpu(&device, &planet), Cpu::new(Arc::clone(&planet), ATLAS_BYTES).unwrap());
    for scheme in [Scheme::Leb, Scheme::Paper] {
        let settings = Settings { scheme, ..Settings::default() };
        let [a, b] = [&mut gpu as &mut dyn Renderer, &mut cpu].map(|renderer| {
            renderer.render_until_complete(&views()[1], &settings, LONG).unwrap();
            let mut mesh: Vec<[[u32; 4]; 3]> = bytemuck::cast_vec(renderer.mesh(&views()[1], scheme).unwrap());
            mesh.sort_unstable();
            mesh
        });
        assert!(a == b && a.len() > 100);
        assert_ne!(a[1..], a[..a.len() - 1]);
    }
}

#[test]
fn pixels_do_not_depend_on_the_order_of_loading() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 11));
    let [first, second, third, _] = <[View; 4]>::try_from(views()).unwrap();
    let frame = |gpu: &mut Gpu, view: &View| {
        let frame = gpu.render_until_complete(view, &Settings::default(), LONG).unwrap();
        assert_eq!(frame.stats.tiles_missing, 0);
        frame
    };
    let mut fresh = gpu(&device, &planet);
    let expected = frame(&mut fresh, &second);
    // Few slots, other views before, and a tile at a time.
    let mut used = Gpu::new(&device, Arc::clone(&planet), 70 * 462_000).unwrap();
    frame(&mut used, &third);
    frame(&mut used, &first);
    while used.render(&second, &Settings::default()).unwrap().stats.tiles_missing > 0 {
        used.update(Duration::from_micros(1));
        std::thread::sleep(Duration::from_millis(1));
    }
    let found = frame(&mut used, &second);
    assert!(expected.colour == found.colour && expected.distance_m == found.distance_m);
    assert!(expected.normal == found.normal && expected.lit == found.lit);
    assert_ne!(expected.colour, frame(&mut used, &first).colour);
}

#[test]
fn views_of_many_sizes_take_turns_and_look_as_they_do_alone() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 9));
    // More sizes than are kept, and one too large to be kept with others.
    let sizes =
        [[64, 36], [1, 1], [36, 64], [100, 50], [50, 100], [2048, 2047], [8, 8], [9, 9], [10, 10], [11, 11], [12, 12]];
    let view = |size: [u32; 2]| View { width: size[0], height: size[1], ..views()[1] };
    let settings = Settings { shadow: Shadow::None, ..Settings::default() };
    let mut turns = gpu(&device, &planet);
    let alone: Vec<Frame> = sizes
        .iter()
        .take(5)
        .map(|&size| gpu(&device, &planet).render_until_complete(&view(size), &settings, LONG).unwrap())
        .collect();
    for _ in 0..2 {
        let found = sizes.map(|size| turns.render_until_complete(&view(size), &settings, LONG).unwrap());
        for (alone, found) in alone.iter().zip(&found) {
            assert!(alone.colour == found.colour && alone.distance_m == found.distance_m, "{}", alone.width);
        }
        assert_ne!(found[0].colour, found[2].colour);
    }
}

#[test]
fn views_that_cannot_be_drawn_are_refused_and_others_go_on() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 8));
    let mut gpu = gpu(&device, &planet);
    let good = views()[0];
    let side = device.wgpu().limits().max_texture_dimension_2d;
    let bad: [fn(&mut View, u32); 4] = [
        |view, _| view.camera.height_m = f64::NAN,
        |view, _| view.width = 0,
        |view, side| view.width = side + 1,
        |view, side| (view.width, view.height) = (side, side),
    ];
    for change in bad {
        let mut view = good;
        change(&mut view, side);
        let error = gpu.render(&view, &Settings::default()).unwrap_err();
        assert!(matches!(error, RenderError::View(ViewError::Number { .. } | ViewError::Size { .. })), "{error}");
    }
    assert!(gpu.render(&good, &Settings::default()).is_ok());
}

#[test]
fn a_lost_device_is_an_error_and_views_on_another_go_on() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 8));
    let mut lost = gpu(&device, &planet);
    assert!(lost.render(&views()[0], &Settings::default()).is_ok());
    device.wgpu().destroy();
    let error = lost.render(&views()[0], &Settings::default()).unwrap_err();
    assert!(matches!(error, RenderError::Device(DeviceError::Lost(_))), "{error}");
    let Some(device) = crate::support::device() else { return };
    assert!(gpu(&device, &planet).render(&views()[0], &Settings::default()).is_ok());
}

#[test]
fn a_host_gets_the_same_pixels_in_its_own_targets() {
    let Some(device) = crate::support::device() else { return };
    let planet = crate::support::planet(&Sample::new(Body::earth(), 10));
    // As a host brings it: the device is its own.
    let device = Device::of_host(device.wgpu().clone(), device.queue().clone());
    let mut gpu = gpu(&device, &planet);
    let view = views()[1];
    let expected = gpu.render_until_complete(&view, &Settings::default(), LONG).unwrap();
    let texture = |format| {
        device.wgpu().create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 320, height: 200, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    };
    let depth = texture(wgpu::TextureFormat::Depth32Float);
    for format in [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Rgba8UnormSrgb] {
        let colour = texture(format);
        let [colour_view, depth_view] =
            [&colour, &depth].map(|t| t.create_view(&wgpu::TextureViewDescriptor::default()));
        let host = HostTargets {
            colour: &colour_view,
            colour_format: format,
            depth: Some((&depth_view, wgpu::TextureFormat::Depth32Float)),
        };
        for _ in 0..6 {
            gpu.present(&view, &Settings::default(), &host).unwrap();
        }
        // A row of 320 words is aligned as copies need it.
        let [colours, depths] = [&colour, &depth].map(|t| crate::support::read_words(&device, t, [320, 200]));
        for (k, pixel) in expected.colour.iter().enumerate() {
            let found = colours[k].to_le_bytes();
            assert!(pixel.iter().zip(found).all(|(&a, b)| a.abs_diff(b) <= 1), "{k}: {pixel:?} {found:?}");
            assert_eq!(expected.distance_m[k] == 0.0, depths[k] == 0, "{k}");
            assert!(expected.distance_m[k] == 0.0 || f32::from_bits(depths[k]) * expected.distance_m[k] >= 0.0499);
        }
    }
    let stats = gpu.present(
        &view,
        &Settings::default(),
        &HostTargets {
            colour: &texture(wgpu::TextureFormat::Bgra8Unorm).create_view(&wgpu::TextureViewDescriptor::default()),
            colour_format: wgpu::TextureFormat::Bgra8Unorm,
            depth: None,
        },
    );
    assert_eq!(stats.unwrap().triangles, expected.stats.triangles);
}
