//! The shading kernels, with and without the overlays.

use std::sync::OnceLock;

use relief_shaders::kernels;

use super::device::Device;
use super::{kernel, paper};

/// Pipelines of `wgsl/frame_shade.wgsl` and `wgsl/frame_shade_paper.wgsl`. Overlays take registers
/// even where none is drawn (a tenth of the time on lavapipe), so pictures without one have a
/// pipeline without them.
pub(super) struct Shading {
    /// Of the pages and of the pixels.
    groups: [wgpu::BindGroupLayout; 2],
    layout: wgpu::PipelineLayout,
    module: wgpu::ShaderModule,
    plain: wgpu::ComputePipeline,
    /// Made when a frame first asks for it.
    overlaid: OnceLock<wgpu::ComputePipeline>,
    /// Made when a frame first asks for the paper's shadows.
    paper: OnceLock<wgpu::ComputePipeline>,
}

impl Shading {
    pub fn new(device: &Device, groups: [wgpu::BindGroupLayout; 2]) -> Self {
        let layout = kernel::pipeline_layout(device, &groups.each_ref().map(Some));
        let module = kernel::module(device, "frame_shade", kernels::FRAME_SHADE);
        let plain = pipeline(device, &layout, &module, false);
        Self { groups, layout, module, plain, overlaid: OnceLock::new(), paper: OnceLock::new() }
    }

    pub fn pipeline(&self, device: &Device, overlaid: bool) -> &wgpu::ComputePipeline {
        if !overlaid {
            return &self.plain;
        }
        self.overlaid.get_or_init(|| pipeline(device, &self.layout, &self.module, true))
    }

    /// With the paper's shadows: a baseline, so with overlays whether one is drawn or not.
    pub fn paper(&self, device: &Device) -> &wgpu::ComputePipeline {
        self.paper.get_or_init(|| {
            let [pages, pixels] = &self.groups;
            let layout = kernel::pipeline_layout(device, &[Some(pages), Some(pixels), Some(&paper::layout(device))]);
            let module = kernel::module(device, "frame_shade_paper", kernels::FRAME_SHADE_PAPER);
            pipeline(device, &layout, &module, true)
        })
    }
}

fn pipeline(
    device: &Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    overlaid: bool,
) -> wgpu::ComputePipeline {
    let constants = [("overlaid", f64::from(u8::from(overlaid)))];
    device.wgpu().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("shade_pixels"),
        layout: Some(layout),
        module,
        entry_point: Some("shade_pixels"),
        compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
        cache: None,
    })
}
