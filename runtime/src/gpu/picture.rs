//! Drawing and shading: `wgsl/frame_draw.wgsl` and `wgsl/lib/shade_pixels.wgsl`.

use relief_shaders::frame::Overlay;
use relief_shaders::kernels;
use relief_shaders::leb::control::Args;

use super::atlas::Atlas;
use super::device::Device;
use super::kernel::{self, Binding};
use super::lists::Lists;
use super::shading::Shading;
use super::targets::{DEPTHS, PLACES, Targets};

/// Pipelines of a picture.
pub(super) struct Picture {
    planet: wgpu::BindGroupLayout,
    corners: wgpu::BindGroupLayout,
    pixels: wgpu::BindGroupLayout,
    draw: wgpu::RenderPipeline,
    shading: Shading,
    sea: wgpu::Buffer,
}

/// Groups over one view's buffers.
pub(super) struct Groups {
    planet: wgpu::BindGroup,
    corners: wgpu::BindGroup,
    pixels: wgpu::BindGroup,
}

impl Picture {
    pub fn new(device: &Device, sea_m: &[f32]) -> Self {
        use Binding::{Depth, Integers, Read, ReadWrite, Uniform};
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let planet = kernel::layout_for(device, "planet", stages, [(0, Uniform)]);
        let corners = kernel::layout_for(device, "corners", wgpu::ShaderStages::VERTEX, [(0, Uniform), (1, Read)]);
        let pixels = kernel::layout(
            device,
            "pixels",
            &[Uniform, Uniform, Integers, Depth, ReadWrite, ReadWrite, ReadWrite, ReadWrite, Uniform],
        );
        let shading = Shading::new(device, [Atlas::layout(device), pixels.clone()]);
        let draw = draw_pipeline(device, &[Some(&planet), Some(&corners)]);
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let sea = kernel::empty(device, "sea", size_of_val(sea_m) as u64, usage);
        device.queue().write_buffer(&sea, 0, bytemuck::cast_slice(sea_m));
        Self { planet, corners, pixels, draw, shading, sea }
    }

    pub fn groups(
        &self,
        device: &Device,
        atlas: &Atlas,
        [view, style, fetched]: [&wgpu::Buffer; 3],
        lists: &Lists,
        targets: &Targets,
    ) -> Groups {
        let whole = wgpu::Buffer::as_entire_binding;
        let texture = wgpu::BindingResource::TextureView;
        Groups {
            planet: kernel::group(device, &self.planet, &[whole(atlas.planet())]),
            corners: kernel::group(device, &self.corners, &[whole(view), whole(&lists.relief)]),
            pixels: kernel::group(
                device,
                &self.pixels,
                &[
                    whole(view),
                    whole(style),
                    texture(&targets.places_view),
                    texture(&targets.depths_view),
                    whole(&targets.colours),
                    whole(&targets.distances),
                    whole(&targets.normals),
                    whole(fetched),
                    whole(&self.sea),
                ],
            ),
        }
    }

    /// Adds the pass that draws.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        groups: &Groups,
        lists: &Lists,
        targets: &Targets,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("draw"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &targets.places_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depths_view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: timestamps,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.draw);
        pass.set_bind_group(0, &groups.planet, &[]);
        pass.set_bind_group(1, &groups.corners, &[]);
        pass.draw_indirect(&lists.args, Args::DRAW_OFFSET);
    }

    /// Adds to a pass the shading of all pixels, with the paper's shadows where its group is given.
    pub fn shade(
        &self,
        device: &Device,
        pass: &mut wgpu::ComputePass<'_>,
        (atlas, paper): (&Atlas, Option<&wgpu::BindGroup>),
        (groups, [width, height]): (&Groups, [u32; 2]),
        overlay: Overlay,
    ) {
        match paper {
            Some(paper) => {
                pass.set_pipeline(self.shading.paper(device));
                pass.set_bind_group(2, paper, &[]);
            }
            None => pass.set_pipeline(self.shading.pipeline(device, overlay != Overlay::None)),
        }
        pass.set_bind_group(0, atlas.group(), &[]);
        pass.set_bind_group(1, &groups.pixels, &[]);
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
    }
}

fn draw_pipeline(device: &Device, groups: &[Option<&wgpu::BindGroupLayout>]) -> wgpu::RenderPipeline {
    let module = kernel::module(device, "frame_draw", kernels::FRAME_DRAW);
    device.wgpu().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("frame_draw"),
        layout: Some(&kernel::pipeline_layout(device, groups)),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("place_corner"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTHS,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("store_place"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(PLACES.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
