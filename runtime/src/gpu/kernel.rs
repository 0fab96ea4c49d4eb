//! Short forms of what every kernel needs: layouts, groups, pipelines, buffers.

use bytemuck::Pod;

use super::device::Device;

/// What a kernel sees at a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binding {
    Uniform,
    Read,
    ReadWrite,
    /// A texture of integers.
    Integers,
    /// A depth texture.
    Depth,
}

impl Binding {
    fn of_wgpu(self) -> wgpu::BindingType {
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let texture = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        match self {
            Self::Uniform => buffer(wgpu::BufferBindingType::Uniform),
            Self::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
            Self::ReadWrite => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
            Self::Integers => texture(wgpu::TextureSampleType::Uint),
            Self::Depth => texture(wgpu::TextureSampleType::Depth),
        }
    }
}

/// A layout with the bindings 0, 1, 2, ... for compute kernels.
pub(super) fn layout(device: &Device, label: &str, bindings: &[Binding]) -> wgpu::BindGroupLayout {
    layout_for(device, label, wgpu::ShaderStages::COMPUTE, (0..).zip(bindings.iter().copied()))
}

/// A layout with some bindings for some stages.
pub(super) fn layout_for(
    device: &Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    bindings: impl IntoIterator<Item = (u32, Binding)>,
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = bindings
        .into_iter()
        .map(|(binding, kind)| wgpu::BindGroupLayoutEntry { binding, visibility, ty: kind.of_wgpu(), count: None })
        .collect();
    device.wgpu().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A group with the bindings 0, 1, 2, ...
pub(super) fn group(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    group_at(device, layout, (0..).zip(resources.iter().cloned()))
}

/// A group with some bindings.
pub(super) fn group_at<'a>(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
) -> wgpu::BindGroup {
    let entries: Vec<_> =
        resources.into_iter().map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.wgpu().create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// A module of a kernel's source.
pub(super) fn module(device: &Device, label: &str, source: &'static str) -> wgpu::ShaderModule {
    device.wgpu().create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

/// A pipeline layout over groups 0, 1, ..., of which some are not used.
pub(super) fn pipeline_layout(device: &Device, groups: &[Option<&wgpu::BindGroupLayout>]) -> wgpu::PipelineLayout {
    device.wgpu().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: groups,
        immediate_size: 0,
    })
}

/// The pipeline of one entry point.
pub(super) fn pipeline(
    device: &Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    entry: &str,
) -> wgpu::ComputePipeline {
    device.wgpu().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: Some(layout),
        module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

/// A uniform buffer with a value.
pub(super) fn uniform<T: Pod>(device: &Device, label: &str, value: &T) -> wgpu::Buffer {
    filled(device, label, bytemuck::bytes_of(value), wgpu::BufferUsages::UNIFORM)
}

/// A buffer of zeros.
pub(super) fn empty(device: &Device, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.wgpu().create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes,
        usage,
        mapped_at_creation: false,
    })
}

/// A buffer with contents.
pub(super) fn filled(device: &Device, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = bytes.len().next_multiple_of(4).max(4) as u64;
    let buffer = empty(device, label, size, usage | wgpu::BufferUsages::COPY_DST);
    device.queue().write_buffer(&buffer, 0, bytes);
    buffer
}
