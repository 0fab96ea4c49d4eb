//! The paper's pyramids in the GPU's memory: group 2 of `wgsl/frame_shade_paper.wgsl`.

use relief_shaders::shadow::paper::{Reading, ShadowPaperMap};
use wgpu::BufferUsages;

use super::device::Device;
use super::kernel::{self, Binding};
use crate::frame::{RenderError, paper_map, refused};
use crate::planet::Planet;

/// Storage buffers that the kernel binds: the pages', the picture's and the pyramids'.
const STORAGE_BUFFERS: u32 = 10;

/// The layout of group 2.
pub(super) fn layout(device: &Device) -> wgpu::BindGroupLayout {
    kernel::layout(device, "paper's pyramids", &[Binding::Uniform, Binding::Read, Binding::Read])
}

/// Group 2, from level 0 of a plane.
///
/// # Errors
/// A device too small for it, or a damaged tile.
pub(super) fn group(device: &Device, planet: &Planet) -> Result<wgpu::BindGroup, RenderError> {
    let limits = device.wgpu().limits();
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    // 4 bytes a texel, and a third for the coarser levels.
    let bytes = (16u64 << (2 * planet.grid().m)) / 3 + 4;
    if limits.max_storage_buffers_per_shader_stage < STORAGE_BUFFERS || bytes > most {
        return Err(
            refused("on a GPU that binds 10 storage buffers as large as the map; elsewhere take `exact`").into()
        );
    }
    let map = paper_map(planet)?;
    let numbers = ShadowPaperMap {
        spacing_m: map.spacing_m,
        m: map.m,
        reading: Reading::Meant as u32,
        ..ShadowPaperMap::default()
    };
    let usage = BufferUsages::STORAGE;
    Ok(device.guard(|| {
        let uniform = kernel::uniform(device, "paper's map", &numbers);
        let heights = kernel::filled(device, "paper's heights", bytemuck::cast_slice(&map.heights_m), usage);
        let extremes = kernel::filled(device, "paper's extremes", bytemuck::cast_slice(&map.extremes_m), usage);
        let resources = [&uniform, &heights, &extremes].map(wgpu::Buffer::as_entire_binding);
        kernel::group(device, &layout(device), &resources)
    })?)
}
