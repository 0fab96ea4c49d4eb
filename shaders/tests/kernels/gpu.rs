//! An adapter for the tests of the kernels: buffers from values, groups, passes, and values back.

use bytemuck::Pod;
use wgpu::util::DeviceExt as _;
use wgpu::{BufferBindingType, BufferUsages};

use crate::page_set::PageSet;

pub const UNIFORM: BufferBindingType = BufferBindingType::Uniform;
pub const READ: BufferBindingType = BufferBindingType::Storage { read_only: true };
pub const WRITE: BufferBindingType = BufferBindingType::Storage { read_only: false };

/// The bindings of a page set: [`Gpu::pages`].
pub const PAGES: [BufferBindingType; 5] = [UNIFORM, READ, READ, READ, WRITE];

pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
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
            .expect("an adapter; RELIEF_NO_GPU=1 leaves out what needs one");
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        Some(Self { device, queue })
    }

    /// The layout of a group whose bindings are numbered from 0.
    pub fn layout(&self, bindings: &[BufferBindingType]) -> wgpu::BindGroupLayout {
        let entries: Vec<_> = (0..)
            .zip(bindings)
            .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                count: None,
            })
            .collect();
        self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    }

    /// A kernel by its entry point.
    pub fn pipeline(
        &self,
        source: &'static str,
        entry: &str,
        groups: &[&wgpu::BindGroupLayout],
    ) -> wgpu::ComputePipeline {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(entry),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &groups.iter().map(|&group| Some(group)).collect::<Vec<_>>(),
            immediate_size: 0,
        });
        self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        })
    }

    /// A buffer of values that can be read back.
    pub fn buffer<T: Pod>(&self, values: &[T], usage: BufferUsages) -> wgpu::Buffer {
        let contents = bytemuck::cast_slice(values);
        let usage = usage | BufferUsages::COPY_SRC;
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    /// Planet, table, heights and bounds of a page set, and no page asked for: see [`PAGES`].
    pub fn pages(&self, set: &PageSet) -> [wgpu::Buffer; 5] {
        let storage = BufferUsages::STORAGE;
        [
            self.buffer(&[set.planet], BufferUsages::UNIFORM),
            self.buffer(&set.table, storage),
            self.buffer(&set.heights, storage),
            self.buffer(&set.bounds, storage),
            self.buffer(&vec![0u32; set.seen.len()], storage),
        ]
    }

    pub fn group(&self, layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// Runs one compute pass.
    pub fn compute(&self, record: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        record(&mut encoder.begin_compute_pass(&Default::default()));
        self.queue.submit([encoder.finish()]);
    }

    /// The values in a buffer, once all that was submitted is done.
    pub fn read<T: Pod>(&self, buffer: &wgpu::Buffer) -> Vec<T> {
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
}
