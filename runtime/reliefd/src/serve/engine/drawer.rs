//! The one renderer of a planet, on the backend that was found.

use std::sync::Arc;
use std::time::Duration;

use relief_formats::tile::TileKey;
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::{Frame, ReliefTriangle, RenderError, Renderer, Scheme, Settings};
use relief_runtime::gpu::{Device, DeviceError, Gpu, ShadowMasks};
use relief_runtime::planet::Planet;
use relief_runtime::residency::Progress;
use relief_runtime::shadow::{Mask, ShadowWindow, mask_in_ram};
use relief_runtime::view::View;

use crate::backend::Backend;

/// A resident set and what draws from it.
pub enum Drawer {
    /// On a GPU; the pipeline of masks is made when one is asked for.
    Gpu(Box<Gpu>, Device, Option<Box<ShadowMasks>>),
    /// On all cores.
    Cpu(Box<Cpu>),
}

impl Drawer {
    /// Of a planet, with up to `atlas_bytes` of tiles.
    ///
    /// # Errors
    /// What the device says, or a damaged tile of the coarsest level.
    pub fn new(backend: &Backend, planet: &Arc<Planet>, atlas_bytes: u64) -> Result<Self, RenderError> {
        Ok(match backend {
            Backend::Gpu(device) => {
                let gpu = Gpu::new(device, Arc::clone(planet), atlas_bytes)?;
                Self::Gpu(Box::new(gpu), device.clone(), None)
            }
            Backend::Cpu => Self::Cpu(Box::new(Cpu::new(Arc::clone(planet), atlas_bytes)?)),
        })
    }

    fn renderer(&mut self) -> &mut dyn Renderer {
        match self {
            Self::Gpu(gpu, ..) => &mut **gpu,
            Self::Cpu(cpu) => &mut **cpu,
        }
    }

    /// Pages in the atlas.
    pub fn resident(&self) -> usize {
        match self {
            Self::Gpu(gpu, ..) => gpu.resident().count(),
            Self::Cpu(cpu) => cpu.resident().count(),
        }
    }

    /// See [`Renderer::render`].
    pub fn render(&mut self, view: &View, settings: &Settings) -> Result<Frame, RenderError> {
        self.renderer().render(view, settings)
    }

    /// See [`Renderer::mesh`].
    pub fn mesh(&mut self, view: &View, scheme: Scheme) -> Result<Vec<ReliefTriangle>, RenderError> {
        self.renderer().mesh(view, scheme)
    }

    /// How much of the sun the nodes of a window see, with the tiles that can be had in `time`.
    ///
    /// # Errors
    /// What the device says.
    pub fn mask(&mut self, window: &ShadowWindow, time: Duration) -> Result<Mask, DeviceError> {
        match self {
            Self::Gpu(gpu, device, masks) => {
                let made = match masks.take() {
                    Some(made) => made,
                    None => Box::new(ShadowMasks::new(device)?),
                };
                masks.insert(made).of(gpu.resident_mut(), window, time)
            }
            Self::Cpu(cpu) => Ok(mask_in_ram(cpu.resident_mut(), window, time)),
        }
    }

    /// See [`Renderer::update`].
    pub fn update(&mut self, budget: Duration) -> Progress {
        self.renderer().update(budget)
    }

    /// See [`Renderer::damaged`].
    pub fn damaged(&mut self) -> Vec<(TileKey, String)> {
        self.renderer().damaged()
    }
}
