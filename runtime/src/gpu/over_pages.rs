//! A compute kernel over the resident pages: run, what it made read back, and the pages that it asked
//! for noted.

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::readback::{Mapping, Readback};
use crate::residency::Resident;

/// The pipeline: pages in group 0, buffers of its own in group 1.
pub(super) struct OverPages {
    device: Device,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

/// What a run made.
pub(super) struct Made<const N: usize> {
    /// The last buffers, on their way back.
    pub buffers: [Mapping; N],
    /// Pages that lack.
    pub lacking: usize,
}

impl OverPages {
    /// Compiles the function `entry` of a source.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(device: &Device, source: &'static str, entry: &str, bindings: &[Binding]) -> Result<Self, DeviceError> {
        device.guard(|| {
            let layout = kernel::layout(device, entry, bindings);
            let layouts = kernel::pipeline_layout(device, &[Some(&Atlas::layout(device)), Some(&layout)]);
            let module = kernel::module(device, entry, source);
            let pipeline = kernel::pipeline(device, &layouts, &module, entry);
            Self { device: device.clone(), layout, pipeline }
        })
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// One dispatch of x times y work groups with the buffers that `bound` makes, the last N of which
    /// are read back.
    ///
    /// # Errors
    /// What the device says.
    pub fn run<const M: usize, const N: usize>(
        &self,
        resident: &mut Resident<Atlas>,
        [x, y]: [u32; 2],
        bound: impl FnOnce(&Device) -> ([wgpu::Buffer; M], [wgpu::Buffer; N]),
    ) -> Result<Made<N>, DeviceError> {
        let device = &self.device;
        let (buffers, seen) = device.guard(|| {
            let (given, made) = bound(device);
            let resources: Vec<_> = given.iter().chain(&made).map(wgpu::Buffer::as_entire_binding).collect();
            let group = kernel::group(device, &self.layout, &resources);
            let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, resident.store().group(), &[]);
                pass.set_bind_group(1, &group, &[]);
                pass.dispatch_workgroups(x, y, 1);
            }
            let readbacks = made.each_ref().map(|buffer| Readback::of(device, &mut encoder, buffer));
            let seen = resident.store().take_seen(&mut encoder);
            device.queue().submit([encoder.finish()]);
            (readbacks.map(Readback::map), seen.map())
        })?;
        let lacking = resident.ask_record(&seen.wait::<u32>(device)?);
        Ok(Made { buffers, lacking })
    }
}
