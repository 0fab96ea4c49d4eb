//! Heights at points by the backend's kernel.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_front::error::ToolError;
use relief_runtime::cpu::Cpu;
use relief_runtime::gpu::{Gpu, Heights as Kernel};
use relief_runtime::planet::Planet;

use crate::backend::Backend;
use crate::errors::{of_device, of_render};

/// Memory for tiles.
const ATLAS_BYTES: u64 = 512 << 20;
/// Longest wait for the tiles of one batch.
const WAIT: Duration = Duration::from_secs(600);

/// Answers for heights.
pub enum Heights {
    /// The kernel and its resident set.
    Gpu(Box<Gpu>, Kernel),
    /// Its twin.
    Cpu(Box<Cpu>),
}

impl Heights {
    /// On a backend, for the planet of the file at `path`.
    pub fn new(backend: &Backend, planet: Arc<Planet>, path: &Path) -> Result<Self, ToolError> {
        let failed = of_render(path);
        Ok(match backend {
            Backend::Gpu(device) => {
                let gpu = Gpu::new(device, planet, ATLAS_BYTES).map_err(failed)?;
                Self::Gpu(Box::new(gpu), Kernel::new(device).map_err(of_device)?)
            }
            Backend::Cpu => Self::Cpu(Box::new(Cpu::new(planet, ATLAS_BYTES).map_err(failed)?)),
        })
    }

    /// Heights of S_level at fixed-point places, metres.
    pub fn at(&mut self, level: u32, places: &[[u32; 2]]) -> Result<Vec<f32>, ToolError> {
        let (heights_m, lacking) = match self {
            Self::Gpu(gpu, kernel) => kernel.at(gpu.resident_mut(), level, places, WAIT).map_err(of_device)?,
            Self::Cpu(cpu) => on_cpu(cpu, level, places),
        };
        if lacking == 0 {
            return Ok(heights_m);
        }
        Err(ToolError::usage(
            format!("{} points at level {level} all over the map", places.len()),
            "the tiles of a batch of points fit the memory for tiles, and can be read",
            "sort the points by place, or check the file with `relief-bake validate`",
        ))
    }
}

/// In parts that the atlas surely holds.
fn on_cpu(cpu: &mut Cpu, level: u32, places: &[[u32; 2]]) -> (Vec<f32>, usize) {
    const PART: usize = 1 << 16;
    let deadline = Instant::now() + WAIT;
    let mut heights_m = Vec::with_capacity(places.len());
    let mut lacking = 0;
    for part in places.chunks(PART) {
        loop {
            let pages = cpu.resident().pages();
            let answers: Vec<f32> = part.iter().map(|&[s, t]| pages.height_m(level, s, t)).collect();
            let lacks = cpu.resident_mut().ask_seen();
            let left = deadline.saturating_duration_since(Instant::now());
            let stuck = lacks > 0
                && (left.is_zero() || {
                    let progress = cpu.resident_mut().update(left);
                    progress.full && progress.loaded == 0
                });
            if lacks == 0 || stuck {
                lacking += usize::from(stuck);
                heights_m.extend(answers);
                break;
            }
        }
    }
    (heights_m, lacking)
}
