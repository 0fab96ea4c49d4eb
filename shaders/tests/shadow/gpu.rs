//! The kernel on an adapter against its twin.

use bytemuck::Pod;
use relief_shaders::kernels::SHADOW_MASK;
use relief_shaders::shadow::{ShadowWindow, WindowCounts, shadow_mask};
use wgpu::util::DeviceExt;
use wgpu::{BufferBindingType, BufferUsages};

use crate::page_set::PageSet;
use crate::paged::cases;

struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    groups: [wgpu::BindGroupLayout; 2],
    mask: wgpu::ComputePipeline,
}

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
        let [read, write] = [true, false].map(|read_only| BufferBindingType::Storage { read_only });
        let uniform = BufferBindingType::Uniform;
        let layout = |types: &[BufferBindingType]| {
            let entries: Vec<_> = (0..)
                .zip(types)
                .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
                    binding,
                    visibility: wgpu::ShaderStages::COMPUTE,
                    ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                    count: None,
                })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
        };
        let groups = [layout(&[uniform, read, read, read, write]), layout(&[uniform, write, write])];
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("shadow_mask"),
            source: wgpu::ShaderSource::Wgsl(SHADOW_MASK.into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&groups[0]), Some(&groups[1])],
            immediate_size: 0,
        });
        let mask = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("shadow_mask"),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("shadow_mask"),
            compilation_options: Default::default(),
            cache: None,
        });
        Some(Self { device, queue, groups, mask })
    }

    fn buffer<T: Pod>(&self, values: &[T], usage: BufferUsages) -> wgpu::Buffer {
        let contents = bytemuck::cast_slice(values);
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    fn group(&self, layout: usize, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = &self.groups[layout];
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

    fn mask(&self, set: &PageSet, window: &ShadowWindow) -> (Vec<u8>, WindowCounts) {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let nodes = (window.columns * window.rows) as usize;
        let seen = vec![0u32; set.seen.len()];
        let pages = [
            self.buffer(&[set.planet], BufferUsages::UNIFORM),
            self.buffer(&set.table, storage),
            self.buffer(&set.heights, storage),
            self.buffer(&set.bounds, storage),
            self.buffer(&seen, storage),
        ];
        let own = [
            self.buffer(&[*window], BufferUsages::UNIFORM),
            self.buffer(&vec![0u32; nodes.div_ceil(4)], storage),
            self.buffer(&[0u32; 3], storage),
        ];
        let groups = [self.group(0, &pages.each_ref()), self.group(1, &own.each_ref())];
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.mask);
            pass.set_bind_group(0, &groups[0], &[]);
            pass.set_bind_group(1, &groups[1], &[]);
            pass.dispatch_workgroups(window.columns.div_ceil(8), window.rows.div_ceil(8), 1);
        }
        self.queue.submit([encoder.finish()]);
        let mut mask: Vec<u8> = self.read(&own[1]);
        mask.truncate(nodes);
        let sums: Vec<u32> = self.read(&own[2]);
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
    for (world, window) in cases() {
        let set = PageSet::of(&world, |level, x, y| level > 0 || (x + y) % 3 != 0);
        let (expected, expected_counts) = shadow_mask(&set.pages(), &window);
        let (mask, counts) = gpu.mask(&set, &window);
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
fn the_window_is_laid_out_as_in_wgsl() {
    let module = naga::front::wgsl::parse_str(SHADOW_MASK).unwrap();
    let (_, found) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("ShadowWindow")).unwrap();
    let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("no struct") };
    assert_eq!(*span as usize, size_of::<ShadowWindow>());
    let offsets: Vec<(&str, usize)> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize)).collect();
    macro_rules! fields {
        ($($f:ident),*) => { [$((stringify!($f), std::mem::offset_of!(ShadowWindow, $f))),*] };
    }
    assert_eq!(offsets[..7], fields!(sun, x, y, columns, rows, level, air));
}
