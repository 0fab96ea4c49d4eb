//! Height and sunlight of points, by the kernel `shadow_points`.

use std::time::{Duration, Instant};

use relief_shaders::kernels;
use relief_shaders::shadow::{PointSun, SunlitPoint};

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::readback::Readback;
use crate::residency::Resident;
use crate::shadow::SunlitPoints;

/// The pipeline.
pub struct ShadowPoints {
    device: Device,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl ShadowPoints {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(device: &Device) -> Result<Self, DeviceError> {
        device.guard(|| {
            let layout = kernel::layout(device, "shadow points", &[Binding::Uniform, Binding::ReadWrite]);
            let layouts = kernel::pipeline_layout(device, &[Some(&Atlas::layout(device)), Some(&layout)]);
            let module = kernel::module(device, "shadow points", kernels::SHADOW_POINTS);
            let pipeline = kernel::pipeline(device, &layouts, &module, "shadow_points");
            Self { device: device.clone(), layout, pipeline }
        })
    }

    /// Height and sunlight at fixed-point places (S, T); again and again until no page lacks, the
    /// atlas is full or `time` is over. The places are one dispatch: some ten thousands.
    ///
    /// # Errors
    /// What the device says.
    pub fn at(
        &self,
        resident: &mut Resident<Atlas>,
        sun: &PointSun,
        places: &[[u32; 2]],
        time: Duration,
    ) -> Result<SunlitPoints, DeviceError> {
        let deadline = Instant::now() + time;
        let asked: Vec<SunlitPoint> =
            places.iter().map(|&[s, t]| SunlitPoint { s, t, ..SunlitPoint::default() }).collect();
        loop {
            let (points, lacking) = self.once(resident, sun, &asked)?;
            if lacking == 0 || !resident.load_more(deadline) {
                return Ok(SunlitPoints { points, lacking });
            }
        }
    }

    fn once(
        &self,
        resident: &mut Resident<Atlas>,
        sun: &PointSun,
        points: &[SunlitPoint],
    ) -> Result<(Vec<SunlitPoint>, usize), DeviceError> {
        let device = &self.device;
        let (answers, seen) = device.guard(|| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let uniform = kernel::uniform(device, "sun", sun);
            let buffer = kernel::filled(device, "points", bytemuck::cast_slice(points), usage);
            let resources = [&uniform, &buffer].map(wgpu::Buffer::as_entire_binding);
            let group = kernel::group(device, &self.layout, &resources);
            let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, resident.store().group(), &[]);
                pass.set_bind_group(1, &group, &[]);
                pass.dispatch_workgroups(points.len().div_ceil(64) as u32, 1, 1);
            }
            let answers = Readback::of(device, &mut encoder, &buffer);
            let seen = resident.store().take_seen(&mut encoder);
            device.queue().submit([encoder.finish()]);
            (answers.map(), seen.map())
        })?;
        let lacks = resident.ask_record(&seen.wait::<u32>(device)?);
        Ok((answers.wait(device)?, lacks))
    }
}
