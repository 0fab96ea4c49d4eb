//! The kernels on an adapter: buffers from a page set, passes as the module's page says.

use bytemuck::Pod;
use relief_shaders::kernels::{LEB_ARGS, PAPER_PASS, PAPER_START};
use relief_shaders::leb::{Args, Params, ReliefTriangle};
use relief_shaders::paper::patch::start_count;
use relief_shaders::paper::{Control, Patch, passes};
use relief_shaders::planet::View;
use wgpu::BufferUsages as Use;

use crate::page_set::PageSet;

pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pages: wgpu::BindGroupLayout,
    lists: wgpu::BindGroupLayout,
    steer: wgpu::BindGroupLayout,
    start: wgpu::ComputePipeline,
    pass: wgpu::ComputePipeline,
    args: wgpu::ComputePipeline,
}

/// What lies at a binding.
#[derive(Clone, Copy)]
enum At {
    Uniform,
    Read,
    Write,
}

impl Gpu {
    /// The adapter of these tests; none where `RELIEF_NO_GPU=1` says that there is none.
    pub fn new() -> Option<Self> {
        if std::env::var_os("RELIEF_NO_GPU").is_some_and(|v| v == "1") {
            eprintln!("RELIEF_NO_GPU=1: the kernels are not run");
            return None;
        }
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .expect("no GPU adapter (RELIEF_NO_GPU=1 leaves out the tests that need one)");
        eprintln!("{:?}", adapter.get_info());
        let descriptor =
            wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..wgpu::DeviceDescriptor::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        let pages = layout(&device, &[At::Uniform, At::Read, At::Read, At::Read, At::Write]);
        let lists = layout(&device, &[At::Uniform, At::Uniform, At::Read, At::Write, At::Write, At::Write]);
        let steer = layout(&device, &[At::Uniform, At::Write, At::Write]);
        let pipeline = |source: &'static str, entry: &str, groups: &[Option<&wgpu::BindGroupLayout>]| {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(entry),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: groups,
                immediate_size: 0,
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        let groups = [Some(&pages), Some(&lists)];
        let start = pipeline(PAPER_START, "paper_start", &groups);
        let pass = pipeline(PAPER_PASS, "paper_pass", &groups);
        let args = pipeline(LEB_ARGS, "leb_args", &[Some(&steer)]);
        Some(Self { start, pass, args, device, queue, pages, lists, steer })
    }

    /// The triangles in the order of their places, and the counts.
    pub fn tessellate(&self, set: &PageSet, view: &View, params: &Params) -> (Vec<ReliefTriangle>, Control) {
        let seen = vec![0u32; set.seen.len()];
        let pages = [
            self.buffer(&[set.planet], Use::UNIFORM),
            self.buffer(&set.table, Use::STORAGE),
            self.buffer(&set.heights, Use::STORAGE),
            self.buffer(&set.bounds, Use::STORAGE),
            self.buffer(&seen, Use::STORAGE),
        ];
        let pages = self.group(&self.pages, &pages.each_ref());
        let eye = self.buffer(&[*view], Use::UNIFORM);
        let limits = self.buffer(&[*params], Use::UNIFORM);
        // One more than the capacity, to see that nothing is written there.
        let list = || self.buffer(&vec![Patch::default(); params.list_capacity as usize + 1], Use::STORAGE);
        let lists = [list(), list()];
        let relief = self.buffer(&vec![ReliefTriangle::default(); params.relief_capacity as usize + 1], Use::STORAGE);
        let control = self.buffer(&[Control::default()], Use::STORAGE);
        let args = self.buffer(&[Args::default()], Use::STORAGE | Use::INDIRECT);
        let group =
            |read: usize| self.group(&self.lists, &[&eye, &limits, &lists[read], &lists[1 - read], &relief, &control]);
        let groups = [group(0), group(1)];
        let steer = self.group(&self.steer, &[&limits, &control, &args]);
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_bind_group(0, &pages, &[]);
            pass.set_bind_group(1, &groups[1], &[]);
            pass.set_pipeline(&self.start);
            pass.dispatch_workgroups(start_count(&set.planet).div_ceil(64), 1, 1);
            for n in 0..=passes(&set.planet) {
                pass.set_bind_group(0, &steer, &[]);
                pass.set_pipeline(&self.args);
                pass.dispatch_workgroups(1, 1, 1);
                if n < passes(&set.planet) {
                    pass.set_bind_group(0, &pages, &[]);
                    pass.set_bind_group(1, &groups[n as usize % 2], &[]);
                    pass.set_pipeline(&self.pass);
                    pass.dispatch_workgroups_indirect(&args, 0);
                }
            }
        }
        self.queue.submit([encoder.finish()]);
        let control = self.read::<Control>(&control)[0];
        let mut triangles = self.read::<ReliefTriangle>(&relief);
        assert_eq!(triangles.pop(), Some(ReliefTriangle::default()), "written beyond the relief's end");
        for list in &lists {
            assert_eq!(self.read::<Patch>(list).pop(), Some(Patch::default()), "written beyond a list's end");
        }
        triangles.truncate(control.relief as usize);
        triangles.sort_unstable_by_key(|t| t.map(|c| (c.t, c.s)));
        (triangles, control)
    }

    fn buffer<T: Pod>(&self, values: &[T], usage: Use) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: usage | Use::COPY_DST | Use::COPY_SRC,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn group(&self, layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    fn read<T: Pod>(&self, source: &wgpu::Buffer) -> Vec<T> {
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: source.size(),
            usage: Use::MAP_READ | Use::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(source, 0, &copy, 0, source.size());
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        bytemuck::pod_collect_to_vec(&copy.get_mapped_range(..).unwrap())
    }
}

fn layout(device: &wgpu::Device, bindings: &[At]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(bindings)
        .map(|(binding, at)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match at {
                    At::Uniform => wgpu::BufferBindingType::Uniform,
                    At::Read => wgpu::BufferBindingType::Storage { read_only: true },
                    At::Write => wgpu::BufferBindingType::Storage { read_only: false },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}
