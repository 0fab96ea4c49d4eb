//! The kernels draw what the twin draws, whatever the adapter.

use std::collections::HashSet;

use relief_shaders::leb::{Mesh, Params, ReliefTriangle};
use relief_shaders::paper::tessellate;

use super::on_gpu::Kernels;
use super::promises::{earth, lump, plain};
use crate::page_set::PageSet;
use crate::tessellation::camera::Camera;
use crate::tessellation::checks::watertight;
use crate::tessellation::page_set::Fault;
use crate::tessellation::planet::{TestPlanet, hash};
use crate::tessellation::scene::Scene;
use crate::tessellation::views::{hard, random};

/// Triangles by their bits.
fn bits(triangles: &[ReliefTriangle]) -> HashSet<[[u32; 4]; 3]> {
    triangles.iter().map(|t| t.map(|c| [c.s, c.t, c.height_m.to_bits(), c.level as u32])).collect()
}

/// Triangles that only one of the two has.
fn differing(a: &[ReliefTriangle], b: &[ReliefTriangle]) -> usize {
    bits(a).symmetric_difference(&bits(b)).count()
}

/// What the kernels draw and what the twin draws.
fn both(kernels: &Kernels, planet: &TestPlanet, pages: &PageSet, camera: Camera) -> [Vec<ReliefTriangle>; 2] {
    let view = camera.view(planet);
    let params = Params::new(&pages.planet, &view, 1 << 17, 1 << 17);
    let twin = tessellate(&pages.pages(), &view, &params);
    let (triangles, control) = kernels.tessellate(pages, &view, &params);
    assert!(!twin.stats.overflow && !control.stats().overflow, "{camera:?} {control:?}");
    assert_eq!(control.relief as usize, triangles.len());
    assert_eq!(control.stats().relief + control.fillers, control.relief);
    if triangles.len() == twin.triangles.len() {
        let (kernel, twin) = (control.stats(), twin.stats);
        assert_eq!((kernel.passes, kernel.relief, kernel.fillers), (twin.passes, twin.relief, twin.fillers));
    }
    [triangles, twin.triangles]
}

#[test]
fn kernels_draw_what_the_twin_draws() {
    let Some(kernels) = Kernels::new() else { return };
    let (mut all, mut other) = (0, 0);
    for (name, planet) in [("earth", earth(9)), ("lump", lump(8)), ("plain", plain(9))] {
        let whole = PageSet::whole(&planet);
        let some = |k, x, y| !hash(u64::from(x), u64::from(y), u64::from(k)).is_multiple_of(3);
        let some = PageSet::of(&planet, Fault::None, some);
        let views = if planet.plane { Vec::new() } else { hard(&planet) };
        let views = views.into_iter().map(|(_, camera)| camera).chain((0..8).map(|n| random(&planet, n, 31)));
        for (n, camera) in views.enumerate() {
            let pages = if n % 3 == 2 { &some } else { &whole };
            let [kernel, twin] = both(&kernels, &planet, pages, camera);
            all += twin.len();
            other += differing(&kernel, &twin);
            // Watertight by itself, whatever the rounding of this adapter.
            let mesh = Mesh { triangles: kernel, ..Mesh::default() };
            let scene = Scene { planet: &planet, pages, camera, view: camera.view(&planet), mesh };
            if let Err(why) = watertight(&scene) {
                panic!("{name} {n}: {why}");
            }
        }
    }
    eprintln!("{other} of {all} triangles differ");
    // Only decisions within rounding of the threshold may differ.
    assert!(all > 10_000 && other * 1000 <= all, "{other} of {all} triangles differ");
}

#[test]
fn the_comparison_notices_another_view() {
    let Some(kernels) = Kernels::new() else { return };
    let planet = earth(9);
    let pages = PageSet::whole(&planet);
    let camera = random(&planet, 2, 11);
    let [kernel, _] = both(&kernels, &planet, &pages, camera);
    let [_, twin] = both(&kernels, &planet, &pages, Camera { pixel_error: 1.9 * camera.pixel_error, ..camera });
    assert!(differing(&kernel, &twin) * 1000 > twin.len());
}

#[test]
fn full_lists_are_told() {
    let Some(kernels) = Kernels::new() else { return };
    let planet = earth(9);
    let pages = PageSet::whole(&planet);
    let view = random(&planet, 2, 11).view(&planet);
    for (list, relief) in [(64, 1 << 16), (1 << 16, 64), (3, 5)] {
        let params = Params::new(&pages.planet, &view, list, relief);
        let (triangles, control) = kernels.tessellate(&pages, &view, &params);
        assert!(control.stats().overflow, "{list} {relief}");
        assert!(triangles.len() <= relief as usize);
        assert!(tessellate(&pages.pages(), &view, &params).stats.overflow);
    }
}
