//! The kernels on an adapter against their twins.

use bytemuck::Pod;
use relief_shaders::kernels::{SHADOW_MASK, SHADOW_PAPER};
use relief_shaders::shadow::paper::{PaperMap, Reading, ShadowPaperMap};
use relief_shaders::shadow::{ShadowWindow, WindowCounts, shadow_mask};
use wgpu::util::DeviceExt;
use wgpu::{BufferBindingType, BufferUsages};

use crate::compare::sun;
use crate::page_set::PageSet;
use crate::paged::cases;
use crate::worlds::fractal_plane;

struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// A kernel with the layouts of its two groups.
struct Kernel {
    groups: [wgpu::BindGroupLayout; 2],
    pipeline: wgpu::ComputePipeline,
}

const UNIFORM: BufferBindingType = BufferBindingType::Uniform;
const READ: BufferBindingType = BufferBindingType::Storage { read_only: true };
const WRITE: BufferBindingType = BufferBindingType::Storage { read_only: false };

impl Gpu {
    /// None where `RELIEF_NO_GPU=1` says that there is no adapter.
    fn new() -> Option<Self> {
        if std::env::var_os("RELIEF_NO_GPU").is_some_and(|v| v == "1") {
            eprintln!("RELIEF_NO_GPU=1: the kernels are not run");
            return None;
        }
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .expect("an adapter; RELIEF_NO_GPU=1 leaves out what needs one");
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        Some(Self { device, queue })
    }

    fn kernel(&self, entry: &str, source: &'static str, groups: [&[BufferBindingType]; 2]) -> Kernel {
        let groups = groups.map(|types| {
            let entries: Vec<_> = (0..)
                .zip(types)
                .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
                    binding,
                    visibility: wgpu::ShaderStages::COMPUTE,
                    ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                    count: None,
                })
                .collect();
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
        });
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(entry),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&groups[0]), Some(&groups[1])],
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        });
        Kernel { groups, pipeline }
    }

    fn buffer<T: Pod>(&self, values: &[T], usage: BufferUsages) -> wgpu::Buffer {
        let contents = bytemuck::cast_slice(values);
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    fn group(&self, layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    fn read<T: Pod>(&self, buffer: &wgpu::Buffer) -> Vec<T> {
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: buffer.size(),
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        bytemuck::pod_collect_to_vec(&copy.get_mapped_range(..).unwrap())
    }

    /// Runs a kernel over columns x rows invocations: the bytes it leaves, and its sums. Its own
    /// group is `uniform`, if it has one, the mask and the sums.
    fn run(
        &self,
        kernel: &Kernel,
        shared: &[&wgpu::Buffer],
        uniform: Option<&wgpu::Buffer>,
        [columns, rows]: [u32; 2],
    ) -> (Vec<u8>, WindowCounts) {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let nodes = (columns * rows) as usize;
        let mask = self.buffer(&vec![0u32; nodes.div_ceil(4)], storage);
        let sums = self.buffer(&[0u32; 3], storage);
        let own: Vec<&wgpu::Buffer> = uniform.into_iter().chain([&mask, &sums]).collect();
        let groups = [self.group(&kernel.groups[0], shared), self.group(&kernel.groups[1], &own)];
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, &groups[0], &[]);
            pass.set_bind_group(1, &groups[1], &[]);
            pass.dispatch_workgroups(columns.div_ceil(8), rows.div_ceil(8), 1);
        }
        self.queue.submit([encoder.finish()]);
        let mut mask: Vec<u8> = self.read(&mask);
        mask.truncate(nodes);
        let sums: Vec<u32> = self.read(&sums);
        let [heights, extremes, steps] = [0, 1, 2].map(|k| u64::from(sums[k]));
        (mask, WindowCounts { rays: nodes as u64, heights, extremes, steps })
    }

    fn shadow_mask(&self, kernel: &Kernel, set: &PageSet, window: &ShadowWindow) -> (Vec<u8>, WindowCounts) {
        let storage = BufferUsages::STORAGE;
        let shared = [
            self.buffer(&[set.planet], BufferUsages::UNIFORM),
            self.buffer(&set.table, storage),
            self.buffer(&set.heights, storage),
            self.buffer(&set.bounds, storage),
            self.buffer(&vec![0u32; set.seen.len()], storage),
        ];
        let uniform = self.buffer(&[*window], BufferUsages::UNIFORM);
        self.run(kernel, &shared.each_ref(), Some(&uniform), [window.columns, window.rows])
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
    let kernel =
        gpu.kernel("shadow_mask", SHADOW_MASK, [&[UNIFORM, READ, READ, READ, WRITE], &[UNIFORM, WRITE, WRITE]]);
    for (world, window) in cases() {
        let set = PageSet::of(&world, |level, x, y| level > 0 || (x + y) % 3 != 0);
        let (expected, expected_counts) = shadow_mask(&set.pages(), &window);
        let (mask, counts) = gpu.shadow_mask(&kernel, &set, &window);
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
        let set = PageSet::of(&world, |_, _, _| true);
        let moved = ShadowWindow { sun: [window.sun[1], window.sun[0], window.sun[2], window.sun[3]], ..window };
        let [a, b] = [window, moved].map(|window| shadow_mask(&set.pages(), &window).0);
        assert!(difference(&a, &b) > 1e-2, "{}", world.name);
    }
}

#[test]
fn the_papers_kernel_shades_as_its_twin_does() {
    let Some(gpu) = Gpu::new() else { return };
    let kernel = gpu.kernel("shadow_paper", SHADOW_PAPER, [&[UNIFORM, READ, READ], &[WRITE, WRITE]]);
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
            let (mask, counts) = gpu.run(&kernel, &shared.each_ref(), None, [256, 256]);
            let share = difference(&mask, &expected);
            println!("paper {q} {reading:?}: {share:.6} differ; {counts:?} against {expected_counts:?}");
            assert!(share < 1e-3, "{share} of the texels differ");
            assert!(counts.steps.abs_diff(expected_counts.steps) * 200 <= expected_counts.steps);
        }
    }
}

/// Whether a struct of WGSL has a size and begins with some members at their offsets.
fn is_laid_out(source: &str, name: &str, size: usize, fields: &[(&str, usize)]) -> bool {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let (_, found) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).unwrap();
    let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("no struct") };
    let offsets: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize)).collect();
    *span as usize == size && offsets[..fields.len()] == *fields
}

#[test]
fn structs_are_laid_out_as_in_wgsl() {
    macro_rules! fields {
        ($t:ty: $($f:ident),*) => { [$((stringify!($f), std::mem::offset_of!($t, $f))),*] };
    }
    let window = fields!(ShadowWindow: sun, x, y, columns, rows, level, air);
    let size = size_of::<ShadowWindow>();
    assert!(is_laid_out(SHADOW_MASK, "ShadowWindow", size, &window));
    let map = fields!(ShadowPaperMap: sun, spacing_m, m, q, reading);
    assert!(is_laid_out(SHADOW_PAPER, "ShadowPaperMap", size_of::<ShadowPaperMap>(), &map));
    assert!(!is_laid_out(SHADOW_MASK, "ShadowWindow", size + 16, &window));
    assert!(!is_laid_out(SHADOW_MASK, "ShadowWindow", size, &[("sun", 0), ("y", 16)]));
}
