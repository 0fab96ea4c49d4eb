//! The paper's shadows in a frame: the kernel against its twin.

use std::sync::Arc;
use std::time::Duration;

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::{Frame, Overlay, RenderError, Renderer, Settings, Shadow};
use relief_runtime::gpu::Gpu;
use relief_runtime::planet::Planet;
use relief_runtime::view::{Camera, Sun, View, ViewError};

use relief_tests::sample_file::{Sample, wavy_q};

const LONG: Duration = Duration::from_secs(100);
const ATLAS_BYTES: u64 = 100 << 20;

/// Hills of some hundred metres.
fn hills(grid: Grid, i: u32, j: u32) -> i32 {
    4 * wavy_q(grid, i, j)
}

/// From above, where level 1 is seen, and from near.
fn views(planet: &Planet) -> [View; 2] {
    let over = |x, y, height_m| Camera::over_plane(planet, x, y, height_m).unwrap();
    [
        View::new(over(7000.0, 7000.0, 26_000.0).looking(10.0, -85.0, 0.0), [240, 200], Sun::at(135.0, 6.0).unwrap()),
        View::new(over(3000.0, 2000.0, 1500.0).looking(40.0, -20.0, 0.0), [240, 200], Sun::at(290.0, 12.0).unwrap()),
    ]
}

/// Share of the ground's pixels whose light or colour differs.
fn apart(a: &Frame, b: &Frame) -> [f64; 2] {
    assert_eq!(a.lit.len(), b.lit.len());
    let ground = a.distance_m.iter().filter(|&&distance_m| distance_m > 0.0).count() as f64;
    let lit = a.lit.iter().zip(&b.lit).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    let unlike = |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(b.iter()).any(|(a, b)| a.abs_diff(*b) > 2);
    [lit as f64 / ground, a.colour.iter().zip(&b.colour).filter(unlike).count() as f64 / ground]
}

#[test]
fn the_gpu_casts_the_papers_shadows_as_the_twin_does() {
    let Some(device) = crate::support::device() else { return };
    let body = Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: 30.0, dy: 25.0 };
    let planet = crate::support::planet(&Sample { q: hills, ..Sample::new(body, 9) });
    let mut gpu = Gpu::new(&device, Arc::clone(&planet), ATLAS_BYTES).unwrap();
    let mut cpu = Cpu::new(Arc::clone(&planet), ATLAS_BYTES).unwrap();
    let paper = Settings { shadow: Shadow::Paper, ..Settings::default() };
    for view in views(&planet) {
        let exact = gpu.render_until_complete(&view, &Settings::default(), LONG).unwrap();
        for settings in [paper, Settings { air: 1.0, ..paper }, Settings { overlay: Overlay::Error, ..paper }] {
            let [a, b] = [&mut gpu as &mut dyn Renderer, &mut cpu]
                .map(|renderer| renderer.render_until_complete(&view, &settings, LONG).unwrap());
            let [lit, colour] = apart(&a, &b);
            assert!(lit < 1e-3 && colour < 2e-3, "{settings:?}: {lit} {colour}");
            let [a_fetches, b_fetches] = [&a, &b].map(|frame| frame.stats.fetches);
            assert!(a_fetches.rays > 8000 && a_fetches.rays.abs_diff(b_fetches.rays) < 50, "{a_fetches:?}");
            assert!(a_fetches.extremes.abs_diff(b_fetches.extremes) * 100 < b_fetches.extremes, "{b_fetches:?}");
            let dark = a.lit.iter().zip(&a.distance_m).filter(|&(&lit, &m)| lit == 0 && m > 0.0).count();
            assert!(dark > 1000, "{dark}");
            // It is another kernel's work, and the exact one comes back after it.
            assert!(apart(&a, &exact)[0] > 2e-3, "{:?}", apart(&a, &exact));
        }
        let again = gpu.render_until_complete(&view, &Settings::default(), LONG).unwrap();
        assert_eq!(again.lit, exact.lit);
    }
}

#[test]
fn over_a_globe_there_is_none() {
    let planet = crate::support::planet(&Sample::new(Body::earth(), 8));
    let view = View::new(Camera::over_globe(1.0, 2.0, 1e5).unwrap(), [16, 16], Sun::over(0.0, 0.0).unwrap());
    let settings = Settings { shadow: Shadow::Paper, ..Settings::default() };
    let mut backends: Vec<Box<dyn Renderer>> = vec![Box::new(Cpu::new(Arc::clone(&planet), ATLAS_BYTES).unwrap())];
    if let Some(device) = crate::support::device() {
        backends.push(Box::new(Gpu::new(&device, Arc::clone(&planet), ATLAS_BYTES).unwrap()));
    }
    for mut backend in backends {
        let error = backend.render(&view, &settings).unwrap_err();
        assert!(matches!(error, RenderError::View(ViewError::Kernel { .. })), "{error}");
    }
}
