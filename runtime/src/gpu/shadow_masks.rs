//! The sunlight of nodes, by the kernel `shadow_mask`.

use std::time::{Duration, Instant};

use relief_shaders::kernels;
use relief_shaders::shadow::mask::{ShadowWindow, WindowCounts};

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::over_pages::OverPages;
use crate::residency::Resident;
use crate::shadow::Mask;

/// Nodes along a side of a work group.
const GROUP: u32 = 8;

/// The pipeline.
pub struct ShadowMasks(OverPages);

impl ShadowMasks {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(device: &Device) -> Result<Self, DeviceError> {
        let bindings = [Binding::Uniform, Binding::ReadWrite, Binding::ReadWrite];
        OverPages::new(device, kernels::SHADOW_MASK, "shadow_mask", &bindings).map(Self)
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
        let nodes = window.columns as usize * window.rows as usize;
        let groups = [window.columns.div_ceil(GROUP), window.rows.div_ceil(GROUP)];
        let made = self.0.run(resident, groups, |device| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            // New buffers hold zeros.
            let mask = kernel::empty(device, "mask", nodes.next_multiple_of(4).max(4) as u64, usage);
            ([kernel::uniform(device, "window", window)], [mask, kernel::empty(device, "fetched", 12, usage)])
        })?;
        let ([lit, fetched], device) = (made.buffers, self.0.device());
        let mut lit: Vec<u8> = lit.wait(device)?;
        lit.truncate(nodes);
        let sums: Vec<u32> = fetched.wait(device)?;
        let sum = |k: usize| sums.get(k).copied().map_or(0, u64::from);
        let counts = WindowCounts { rays: nodes as u64, heights: sum(0), extremes: sum(1), steps: sum(2) };
        Ok((lit, counts, made.lacking))
    }
}
