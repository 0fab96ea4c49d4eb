//! A finished picture in the host's targets: `wgsl/frame_present.wgsl`.

use std::collections::HashMap;

use relief_shaders::kernels;

use super::device::Device;
use super::kernel::{self, Binding};
use super::targets::Targets;

/// Where the host wants a picture (paper 003): views of its own textures, of the picture's size.
#[derive(Clone, Copy, Debug)]
pub struct HostTargets<'a> {
    /// Usage `RENDER_ATTACHMENT`; overwritten everywhere.
    pub colour: &'a wgpu::TextureView,
    /// Its format: any that can be rendered to.
    pub colour_format: wgpu::TextureFormat,
    /// A depth target with its format; overwritten everywhere with [`crate::view::NEAR_M`] over the
    /// distance along the axis of sight, 0 in the sky (reversed z, infinite far plane).
    pub depth: Option<(&'a wgpu::TextureView, wgpu::TextureFormat)>,
}

type Formats = (wgpu::TextureFormat, Option<wgpu::TextureFormat>);

/// Pipelines, one for each pair of formats.
pub(super) struct Present {
    layout: wgpu::BindGroupLayout,
    pipelines: HashMap<Formats, wgpu::RenderPipeline>,
}

impl Present {
    pub fn new(device: &Device) -> Self {
        let bindings = [(1, Binding::Uniform), (2, Binding::Read), (3, Binding::Read)];
        let layout = kernel::layout_for(device, "present", wgpu::ShaderStages::FRAGMENT, bindings);
        Self { layout, pipelines: HashMap::new() }
    }

    /// Adds to an encoder the pass that fills the host's targets.
    pub fn encode(
        &mut self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::Buffer,
        targets: &Targets,
        host: &HostTargets<'_>,
    ) {
        let formats = (host.colour_format, host.depth.map(|(_, format)| format));
        let layout = &self.layout;
        let pipeline = self.pipelines.entry(formats).or_insert_with(|| pipeline(device, layout, formats));
        let buffers = [view, &targets.colours, &targets.distances].map(wgpu::Buffer::as_entire_binding);
        let group = kernel::group_at(device, layout, (1..).zip(buffers));
        let overwrite = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: host.colour,
                depth_slice: None,
                resolve_target: None,
                ops: overwrite,
            })],
            depth_stencil_attachment: host.depth.map(|(view, _)| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn pipeline(device: &Device, layout: &wgpu::BindGroupLayout, (colour, depth): Formats) -> wgpu::RenderPipeline {
    let module = kernel::module(device, "frame_present", kernels::FRAME_PRESENT);
    let linear = [("linear", f64::from(u8::from(colour.is_srgb())))];
    device.wgpu().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("frame_present"),
        layout: Some(&kernel::pipeline_layout(device, &[Some(layout)])),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("cover"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: depth.map(|format| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(if depth.is_some() { "present_depth" } else { "present" }),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &linear, ..Default::default() },
            targets: &[Some(colour.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
