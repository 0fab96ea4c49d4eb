//! Heights at points, by the kernel `heights`.

use std::time::{Duration, Instant};

use relief_shaders::kernels;
use relief_shaders::pages::Point;

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::readback::Readback;
use crate::residency::Resident;

/// Points of one dispatch.
const BATCH: usize = 1 << 16;

/// The pipeline.
pub struct Heights {
    device: Device,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Heights {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(device: &Device) -> Result<Self, DeviceError> {
        device.guard(|| {
            let layout = kernel::layout(device, "heights", &[Binding::ReadWrite]);
            let layouts = kernel::pipeline_layout(device, &[Some(&Atlas::layout(device)), Some(&layout)]);
            let module = kernel::module(device, "heights", kernels::HEIGHTS);
            let pipeline = kernel::pipeline(device, &layouts, &module, "heights_at");
            Self { device: device.clone(), layout, pipeline }
        })
    }

    /// Heights of S_level at fixed-point places (S, T), metres, and how many batches of points
    /// still lack a page when `time` is over: their heights come from coarser ones.
    ///
    /// # Errors
    /// What the device says.
    pub fn at(
        &self,
        resident: &mut Resident<Atlas>,
        level: u32,
        places: &[[u32; 2]],
        time: Duration,
    ) -> Result<(Vec<f32>, usize), DeviceError> {
        let deadline = Instant::now() + time;
        let mut heights_m = Vec::with_capacity(places.len());
        let mut lacking = 0;
        for places in places.chunks(BATCH) {
            let points: Vec<Point> = places.iter().map(|&[s, t]| Point { s, t, level, height_m: 0.0 }).collect();
            loop {
                let (answers, lacks) = self.once(resident, &points)?;
                let left = deadline.saturating_duration_since(Instant::now());
                let stuck = lacks > 0
                    && (left.is_zero() || {
                        let progress = resident.update(left);
                        progress.full && progress.loaded == 0
                    });
                if lacks == 0 || stuck {
                    lacking += usize::from(stuck);
                    heights_m.extend(answers.iter().map(|point| point.height_m));
                    break;
                }
            }
        }
        Ok((heights_m, lacking))
    }

    fn once(&self, resident: &mut Resident<Atlas>, points: &[Point]) -> Result<(Vec<Point>, usize), DeviceError> {
        let device = &self.device;
        let (answers, seen) = device.guard(|| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let buffer = kernel::filled(device, "points", bytemuck::cast_slice(points), usage);
            let group = kernel::group(device, &self.layout, &[buffer.as_entire_binding()]);
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
