//! The kernels on an adapter against their twins.

use relief_shaders::kernels::{SHADOW_MASK, SHADOW_PAPER};
use relief_shaders::shadow::paper::{PaperMap, Reading, ShadowPaperMap};
use relief_shaders::shadow::{ShadowWindow, WindowCounts, shadow_mask};
use wgpu::{BufferBindingType, BufferUsages};

use super::compare::sun;
use super::paged::cases;
use super::worlds::fractal_plane;
use crate::gpu::{Gpu, PAGES, READ, UNIFORM, WRITE};
use crate::page_set::PageSet;

/// A kernel that writes a mask, with the layouts of its two groups.
struct Kernel {
    groups: [wgpu::BindGroupLayout; 2],
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    fn new(gpu: &Gpu, entry: &str, source: &'static str, groups: [&[BufferBindingType]; 2]) -> Self {
        let groups = groups.map(|bindings| gpu.layout(bindings));
        Self { pipeline: gpu.pipeline(source, entry, &groups.each_ref()), groups }
    }

    /// Runs it over columns x rows invocations: the bytes it leaves, and its sums. Its own group
    /// is `uniform`, if it has one, the mask and the sums.
    fn run(
        &self,
        gpu: &Gpu,
        shared: &[&wgpu::Buffer],
        uniform: Option<&wgpu::Buffer>,
        [columns, rows]: [u32; 2],
    ) -> (Vec<u8>, WindowCounts) {
        let nodes = (columns * rows) as usize;
        let mask = gpu.buffer(&vec![0u32; nodes.div_ceil(4)], BufferUsages::STORAGE);
        let sums = gpu.buffer(&[0u32; 3], BufferUsages::STORAGE);
        let own: Vec<&wgpu::Buffer> = uniform.into_iter().chain([&mask, &sums]).collect();
        let groups = [gpu.group(&self.groups[0], shared), gpu.group(&self.groups[1], &own)];
        gpu.compute(|pass| {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &groups[0], &[]);
            pass.set_bind_group(1, &groups[1], &[]);
            pass.dispatch_workgroups(columns.div_ceil(8), rows.div_ceil(8), 1);
        });
        let mut mask: Vec<u8> = gpu.read(&mask);
        mask.truncate(nodes);
        let sums: Vec<u32> = gpu.read(&sums);
        let [heights, extremes, steps] = [0, 1, 2].map(|k| u64::from(sums[k]));
        (mask, WindowCounts { rays: nodes as u64, heights, extremes, steps })
    }
}

/// Share of the nodes whose light differs by more than a hundredth.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 2).count() as f64 / a.len() as f64
}

#[test]
fn the_kernel_shades_as_its_twin_does() {
    let Some(gpu) = Gpu::new() else { return };
    let kernel = Kernel::new(&gpu, "shadow_mask", SHADOW_MASK, [&PAGES, &[UNIFORM, WRITE, WRITE]]);
    for (world, window) in cases() {
        let set = PageSet::of_world(&world, |level, x, y| level > 0 || (x + y) % 3 != 0);
        let (expected, expected_counts) = shadow_mask(&set.pages(), &window);
        let uniform = gpu.buffer(&[window], BufferUsages::UNIFORM);
        let size = [window.columns, window.rows];
        let (mask, counts) = kernel.run(&gpu, &gpu.pages(&set).each_ref(), Some(&uniform), size);
        let share = difference(&mask, &expected);
        println!("{}: {share:.6} differ; {counts:?} against {expected_counts:?}", world.name);
        assert!(share < 1e-3, "{}: {share} of the nodes differ", world.name);
        let near = |a: u64, b: u64| a.abs_diff(b) * 200 <= b;
        assert!(near(counts.heights, expected_counts.heights) && near(counts.extremes, expected_counts.extremes));
    }
}

#[test]
fn another_sun_is_noticed() {
    for (world, window) in cases() {
        let set = PageSet::of_world(&world, |_, _, _| true);
        let moved = ShadowWindow { sun: [window.sun[1], window.sun[0], window.sun[2], window.sun[3]], ..window };
        let [a, b] = [window, moved].map(|window| shadow_mask(&set.pages(), &window).0);
        assert!(difference(&a, &b) > 1e-2, "{}", world.name);
    }
}

#[test]
fn the_papers_kernel_shades_as_its_twin_does() {
    let Some(gpu) = Gpu::new() else { return };
    let kernel = Kernel::new(&gpu, "shadow_paper", SHADOW_PAPER, [&[UNIFORM, READ, READ], &[WRITE, WRITE]]);
    let world = fractal_plane(8, [30.0, 20.0], 1500.0);
    let heights_m = (0..256 * 256).map(|k| world.nodes_m[k / 256 * 257 + k % 256]).collect();
    let map = PaperMap::new(8, [30.0, 20.0], heights_m);
    for (azimuth_deg, elevation_deg, q) in [(135.0, 8.0, 0), (0.0, 15.0, 1), (270.0, 5.0, 2), (211.0, 20.0, 0)] {
        for reading in [Reading::Printed, Reading::Meant] {
            let [x, y, z] = sun(azimuth_deg, elevation_deg);
            let (expected, expected_counts) = map.paper_mask(q, [x, y, z], reading);
            let numbers = ShadowPaperMap {
                sun: [x, y, z, 0.0],
                spacing_m: map.spacing_m,
                m: map.m,
                q,
                reading: reading as u32,
                ..ShadowPaperMap::default()
            };
            let shared = [
                gpu.buffer(&[numbers], BufferUsages::UNIFORM),
                gpu.buffer(&map.heights_m, BufferUsages::STORAGE),
                gpu.buffer(&map.extremes_m, BufferUsages::STORAGE),
            ];
            let (mask, counts) = kernel.run(&gpu, &shared.each_ref(), None, [256, 256]);
            let share = difference(&mask, &expected);
            println!("paper {q} {reading:?}: {share:.6} differ; {counts:?} against {expected_counts:?}");
            assert!(share < 1e-3, "{share} of the texels differ");
            assert!(counts.steps.abs_diff(expected_counts.steps) * 200 <= expected_counts.steps);
        }
    }
}
