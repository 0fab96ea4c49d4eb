//! The kernels draw what the twin draws, whatever the adapter.

use std::collections::HashSet;

use relief_shaders::kernels::PAPER_PASS;
use relief_shaders::leb::{Mesh, Params, ReliefTriangle};
use relief_shaders::paper::{Control, Patch, tessellate};

use super::gpu::Gpu;
use super::promises::{earth, lump, plain};
use crate::camera::Camera;
use crate::checks::watertight;
use crate::page_set::{Fault, PageSet};
use crate::planet::{TestPlanet, hash};
use crate::scene::Scene;
use crate::views::{hard, random};

/// Triangles by their bits.
fn bits(triangles: &[ReliefTriangle]) -> HashSet<[[u32; 4]; 3]> {
    triangles.iter().map(|t| t.map(|c| [c.s, c.t, c.height_m.to_bits(), c.level as u32])).collect()
}

/// Triangles that only one of the two has.
fn differing(a: &[ReliefTriangle], b: &[ReliefTriangle]) -> usize {
    bits(a).symmetric_difference(&bits(b)).count()
}

/// What the kernels draw and what the twin draws.
fn both(gpu: &Gpu, planet: &TestPlanet, pages: &PageSet, camera: Camera) -> [Vec<ReliefTriangle>; 2] {
    let view = camera.view(planet);
    let params = Params::new(&pages.planet, &view, 1 << 17, 1 << 17);
    let twin = tessellate(&pages.pages(), &view, &params);
    let (triangles, control) = gpu.tessellate(pages, &view, &params);
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
    let Some(gpu) = Gpu::new() else { return };
    let (mut all, mut other) = (0, 0);
    for (name, planet) in [("earth", earth(9)), ("lump", lump(8)), ("plain", plain(9))] {
        let whole = PageSet::whole(&planet);
        let some = |k, x, y| !hash(u64::from(x), u64::from(y), u64::from(k)).is_multiple_of(3);
        let some = PageSet::of(&planet, Fault::None, some);
        let views = if planet.plane { Vec::new() } else { hard(&planet) };
        let views = views.into_iter().map(|(_, camera)| camera).chain((0..8).map(|n| random(&planet, n, 31)));
        for (n, camera) in views.enumerate() {
            let pages = if n % 3 == 2 { &some } else { &whole };
            let [kernel, twin] = both(&gpu, &planet, pages, camera);
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
    let Some(gpu) = Gpu::new() else { return };
    let planet = earth(9);
    let pages = PageSet::whole(&planet);
    let camera = random(&planet, 2, 11);
    let [kernel, _] = both(&gpu, &planet, &pages, camera);
    let [_, twin] = both(&gpu, &planet, &pages, Camera { pixel_error: 1.9 * camera.pixel_error, ..camera });
    assert!(differing(&kernel, &twin) * 1000 > twin.len());
}

#[test]
fn full_lists_are_told() {
    let Some(gpu) = Gpu::new() else { return };
    let planet = earth(9);
    let pages = PageSet::whole(&planet);
    let view = random(&planet, 2, 11).view(&planet);
    for (list, relief) in [(64, 1 << 16), (1 << 16, 64), (3, 5)] {
        let params = Params::new(&pages.planet, &view, list, relief);
        let (triangles, control) = gpu.tessellate(&pages, &view, &params);
        assert!(control.stats().overflow, "{list} {relief}");
        assert!(triangles.len() <= relief as usize);
        assert!(tessellate(&pages.pages(), &view, &params).stats.overflow);
    }
}

#[test]
fn shared_structs_have_one_layout() {
    let module = naga::front::wgsl::parse_str(PAPER_PASS).unwrap();
    let size = |name: &str| {
        let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).unwrap().1;
        let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
        let members: Vec<_> = members.iter().map(|m| (m.name.clone().unwrap(), m.offset)).collect();
        (*span as usize, members)
    };
    let (patch, fields) = size("Patch");
    assert_eq!(patch, size_of::<Patch>());
    let offsets = [std::mem::offset_of!(Patch, s), std::mem::offset_of!(Patch, t), std::mem::offset_of!(Patch, code)];
    assert!(fields.iter().map(|f| f.1 as usize).eq(offsets), "{fields:?}");
    let (control, fields) = size("PaperControl");
    assert_eq!(control, size_of::<Control>());
    let named = [
        ("count_in", std::mem::offset_of!(Control, count_in)),
        ("count_out", std::mem::offset_of!(Control, count_out)),
        ("relief", std::mem::offset_of!(Control, relief)),
        ("overflow", std::mem::offset_of!(Control, overflow)),
        ("tested", std::mem::offset_of!(Control, tested)),
        ("culled", std::mem::offset_of!(Control, culled)),
        ("passes", std::mem::offset_of!(Control, passes)),
        ("horizon", std::mem::offset_of!(Control, horizon)),
        ("split", std::mem::offset_of!(Control, split)),
        ("fillers", std::mem::offset_of!(Control, fillers)),
        ("padding_0", std::mem::offset_of!(Control, padding)),
    ];
    assert!(named.iter().zip(&fields).all(|(a, b)| a.0 == b.0 && a.1 == b.1 as usize), "{fields:?}");
    // leb_args reads the same words by the names of its own struct.
    let module = naga::front::wgsl::parse_str(relief_shaders::kernels::LEB_ARGS).unwrap();
    let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("LebControl")).unwrap().1;
    let naga::TypeInner::Struct { members, .. } = &found.inner else { panic!("LebControl is no struct") };
    for member in members {
        let own = fields.iter().find(|f| Some(&f.0) == member.name.as_ref());
        assert_eq!(own.map(|f| f.1), Some(member.offset), "{:?}", member.name);
    }
}
