//! Heights at points, by the kernel `heights`.

use std::time::{Duration, Instant};

use relief_shaders::kernels;
use relief_shaders::pages::Point;

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::over_pages::OverPages;
use crate::residency::Resident;

/// Points of one dispatch.
const BATCH: usize = 1 << 16;

/// The pipeline.
pub struct Heights(OverPages);

impl Heights {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(device: &Device) -> Result<Self, DeviceError> {
        OverPages::new(device, kernels::HEIGHTS, "heights_at", &[Binding::ReadWrite]).map(Self)
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
                if lacks == 0 || !resident.load_more(deadline) {
                    lacking += usize::from(lacks > 0);
                    heights_m.extend(answers.iter().map(|point| point.height_m));
                    break;
                }
            }
        }
        Ok((heights_m, lacking))
    }

    fn once(&self, resident: &mut Resident<Atlas>, points: &[Point]) -> Result<(Vec<Point>, usize), DeviceError> {
        let made = self.0.run(resident, [points.len().div_ceil(64) as u32, 1], |device| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            ([], [kernel::filled(device, "points", bytemuck::cast_slice(points), usage)])
        })?;
        let [answers] = made.buffers;
        Ok((answers.wait(self.0.device())?, made.lacking))
    }
}
