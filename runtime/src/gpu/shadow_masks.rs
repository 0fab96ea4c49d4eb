//! The sunlight of nodes, by the kernel `shadow_mask`.

use std::time::{Duration, Instant};

use relief_shaders::kernels;
use relief_shaders::shadow::mask::{ShadowWindow, WindowCounts};

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::readback::Readback;
use crate::residency::Resident;
use crate::shadow::Mask;

/// Nodes along a side of a work group.
const GROUP: u32 = 8;

/// The pipeline.
pub struct ShadowMasks {
    device: Device,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl ShadowMasks {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(device: &Device) -> Result<Self, DeviceError> {
        device.guard(|| {
            let bindings = [Binding::Uniform, Binding::ReadWrite, Binding::ReadWrite];
            let layout = kernel::layout(device, "shadow mask", &bindings);
            let layouts = kernel::pipeline_layout(device, &[Some(&Atlas::layout(device)), Some(&layout)]);
            let module = kernel::module(device, "shadow mask", kernels::SHADOW_MASK);
            let pipeline = kernel::pipeline(device, &layouts, &module, "shadow_mask");
            Self { device: device.clone(), layout, pipeline }
        })
    }

    /// The sunlight of a window's nodes; again and again until no page lacks, the atlas is full or
    /// `time` is over. A window is one dispatch: some hundred nodes a side.
    ///
    /// # Errors
    /// What the device says.
    pub fn of(
        &self,
        resident: &mut Resident<Atlas>,
        window: &ShadowWindow,
        time: Duration,
    ) -> Result<Mask, DeviceError> {
        let deadline = Instant::now() + time;
        loop {
            let (lit, counts, lacks) = self.once(resident, window)?;
            if lacks == 0 || !resident.load_more(deadline) {
                return Ok(Mask { lit, counts, lacking: lacks });
            }
        }
    }

    fn once(
        &self,
        resident: &mut Resident<Atlas>,
        window: &ShadowWindow,
    ) -> Result<(Vec<u8>, WindowCounts, usize), DeviceError> {
        let device = &self.device;
        let nodes = window.columns as usize * window.rows as usize;
        let (lit, fetched, seen) = device.guard(|| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let uniform = kernel::uniform(device, "window", window);
            // New buffers hold zeros.
            let mask = kernel::empty(device, "mask", nodes.next_multiple_of(4).max(4) as u64, usage);
            let fetched = kernel::empty(device, "fetched", 12, usage);
            let resources = [&uniform, &mask, &fetched].map(wgpu::Buffer::as_entire_binding);
            let group = kernel::group(device, &self.layout, &resources);
            let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, resident.store().group(), &[]);
                pass.set_bind_group(1, &group, &[]);
                pass.dispatch_workgroups(window.columns.div_ceil(GROUP), window.rows.div_ceil(GROUP), 1);
            }
            let readbacks = [&mask, &fetched].map(|buffer| Readback::of(device, &mut encoder, buffer));
            let seen = resident.store().take_seen(&mut encoder);
            device.queue().submit([encoder.finish()]);
            let [mask, fetched] = readbacks.map(Readback::map);
            (mask, fetched, seen.map())
        })?;
        let lacks = resident.ask_record(&seen.wait::<u32>(device)?);
        let mut lit: Vec<u8> = lit.wait(device)?;
        lit.truncate(nodes);
        let sums: Vec<u32> = fetched.wait(device)?;
        let sum = |k: usize| sums.get(k).copied().map_or(0, u64::from);
        let counts = WindowCounts { rays: nodes as u64, heights: sum(0), extremes: sum(1), steps: sum(2) };
        Ok((lit, counts, lacks))
    }
}
