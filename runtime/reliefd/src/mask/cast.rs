//! Rays from every node of a rectangle, on either backend.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use relief_front::error::ToolError;
use relief_front::window::Rectangle;
use relief_runtime::cpu::Cpu;
use relief_runtime::gpu::{Gpu, ShadowMasks};
use relief_runtime::planet::Planet;
use relief_runtime::shadow::{Mask, ShadowWindow, WindowCounts, mask_in_ram, sun_of};
use relief_runtime::view::Sun;

use super::parts::{Whole, parts};
use super::sweep::Sweep;
use crate::backend::{ATLAS_BYTES, Backend};
use crate::errors::{of_device, of_render};

/// Nodes along a side of what is cast at once: few pages do for its rays.
const PART: u32 = 512;
/// Longest wait for the pages of a part.
const WAIT: Duration = Duration::from_secs(600);
/// A plane's level is swept whole when its nodes take no more than this.
const SWEPT_BYTES: u64 = 4 << 30;

/// What makes the masks of a level.
pub enum Caster {
    /// All rays of one direction over a plane at once, hard edges only.
    Sweep(Sweep),
    /// A ray from each node.
    Rays(Rays),
}

/// A backend and the level its rays start from.
pub struct Rays {
    planet: Arc<Planet>,
    level: u32,
    kernel: Kernel,
}

enum Kernel {
    /// On a GPU.
    Gpu(Box<Gpu>, ShadowMasks),
    /// Its twin.
    Cpu(Box<Cpu>),
}

impl Caster {
    /// For a level that the file at `path` has; `single` where each ray is to be cast on its own,
    /// as a soft edge or air need it.
    ///
    /// # Errors
    /// A backend that gave up, or a damaged tile.
    pub fn new(
        planet: Arc<Planet>,
        path: &Path,
        level: u32,
        backend: &Backend,
        single: bool,
    ) -> Result<Self, ToolError> {
        let grid = planet.grid();
        let bytes = 4 * u64::from(grid.width(level)) * u64::from(grid.height(level));
        let failed = of_render(path);
        let kernel = match backend {
            Backend::Cpu if grid.plane && !single && bytes <= SWEPT_BYTES => {
                return Sweep::new(planet, level).map(Self::Sweep).map_err(ToolError::of_file(path));
            }
            Backend::Cpu => Kernel::Cpu(Box::new(Cpu::new(Arc::clone(&planet), ATLAS_BYTES).map_err(failed)?)),
            Backend::Gpu(device) => {
                let gpu = Gpu::new(device, Arc::clone(&planet), ATLAS_BYTES).map_err(failed)?;
                Kernel::Gpu(Box::new(gpu), ShadowMasks::new(device).map_err(of_device)?)
            }
        };
        Ok(Self::Rays(Rays { planet, level, kernel }))
    }

    /// The mask of a rectangle of nodes under a sun of a radius in degrees and air of a density
    /// (both 0 for a sweep), rows from the north, and what its rays fetched; a sweep
    /// counts none.
    ///
    /// # Errors
    /// Pages that lack, or a device that gave up.
    pub fn mask(
        &mut self,
        sun: &Sun,
        [radius_deg, air]: [f64; 2],
        rectangle: Rectangle,
    ) -> Result<(Vec<u8>, Option<WindowCounts>), ToolError> {
        let sun = sun_of(sun, radius_deg);
        match self {
            Self::Sweep(sweep) => Ok((sweep.mask([sun[0], sun[1], sun[2]], rectangle), None)),
            Self::Rays(rays) => rays.mask(sun, air as f32, rectangle).map(|(mask, counts)| (mask, Some(counts))),
        }
    }
}

impl Rays {
    fn mask(&mut self, sun: [f32; 4], air: f32, rectangle: Rectangle) -> Result<(Vec<u8>, WindowCounts), ToolError> {
        let like = ShadowWindow { sun, air, level: self.level, ..ShadowWindow::default() };
        let mut whole = Whole::new(rectangle);
        let mut all = WindowCounts::default();
        for part in parts(rectangle, self.planet.grid(), like, PART) {
            let mask = self.part(&part.window)?;
            whole.put(&part, &mask.lit);
            all.rays += mask.counts.rays;
            all.heights += mask.counts.heights;
            all.extremes += mask.counts.extremes;
            all.steps += mask.counts.steps;
        }
        Ok((whole.into_lit(), all))
    }

    fn part(&mut self, window: &ShadowWindow) -> Result<Mask, ToolError> {
        let mask = match &mut self.kernel {
            Kernel::Gpu(gpu, masks) => masks.of(gpu.resident_mut(), window, WAIT).map_err(of_device)?,
            Kernel::Cpu(cpu) => mask_in_ram(cpu.resident_mut(), window, WAIT),
        };
        if mask.lacking == 0 {
            return Ok(mask);
        }
        Err(ToolError::usage(
            format!("{} tiles that rays need at level {} are not at hand", mask.lacking, self.level),
            "the tiles on the way of a part's rays can be read and fit the memory for tiles",
            "give a coarser --level, or check the file with `relief-bake validate`",
        ))
    }
}
