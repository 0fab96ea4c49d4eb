//! Height and sunlight of points, by the kernel `shadow_points`.

use std::time::{Duration, Instant};

use relief_shaders::kernels;
use relief_shaders::shadow::{PointSun, SunlitPoint};

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::over_pages::OverPages;
use crate::residency::Resident;
use crate::shadow::SunlitPoints;

/// The pipeline.
pub struct ShadowPoints(OverPages);

impl ShadowPoints {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(device: &Device) -> Result<Self, DeviceError> {
        let bindings = [Binding::Uniform, Binding::ReadWrite];
        OverPages::new(device, kernels::SHADOW_POINTS, "shadow_points", &bindings).map(Self)
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
        let made = self.0.run(resident, [points.len().div_ceil(64) as u32, 1], |device| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let uniform = kernel::uniform(device, "sun", sun);
            ([uniform], [kernel::filled(device, "points", bytemuck::cast_slice(points), usage)])
        })?;
        let [answers] = made.buffers;
        Ok((answers.wait(self.0.device())?, made.lacking))
    }
}
