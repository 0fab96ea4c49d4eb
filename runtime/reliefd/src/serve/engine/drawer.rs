//! The one renderer of a planet, on the backend that was found.

use std::sync::Arc;
use std::time::Duration;

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::{Frame, ReliefTriangle, RenderError, Renderer, Scheme, Settings};
use relief_runtime::gpu::{DeviceError, Gpu, ShadowMasks};
use relief_runtime::planet::Planet;
use relief_runtime::residency::Progress;
use relief_runtime::shadow::{Mask, ShadowWindow, mask_in_ram};
use relief_runtime::view::View;

use crate::backend::Backend;

/// A resident set and what draws from it.
pub enum Drawer {
    /// On a GPU; the pipeline of masks is made when one is asked for.
    Gpu(Box<Gpu>, Option<Box<ShadowMasks>>),
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
                Self::Gpu(Box::new(gpu), None)
            }
            Backend::Cpu => Self::Cpu(Box::new(Cpu::new(Arc::clone(planet), atlas_bytes)?)),
        })
    }

    fn renderer(&mut self) -> &mut dyn Renderer {
        match self {
            Self::Gpu(gpu, _) => &mut **gpu,
            Self::Cpu(cpu) => &mut **cpu,
        }
    }

    /// Pages in the atlas.
    pub fn resident(&self) -> usize {
        match self {
            Self::Gpu(gpu, _) => gpu.resident().count(),
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

    /// How much of the sun the nodes of a window see, with the tiles that are there; those that lack
    /// are wanted from now on.
    ///
    /// # Errors
    /// What the device says.
    pub fn mask(&mut self, window: &ShadowWindow) -> Result<Mask, DeviceError> {
        match self {
            Self::Gpu(gpu, masks) => {
                let made = match masks.take() {
                    Some(made) => made,
                    None => Box::new(ShadowMasks::new(gpu.device())?),
                };
                masks.insert(made).of(gpu.resident_mut(), window, Duration::ZERO)
            }
            Self::Cpu(cpu) => Ok(mask_in_ram(cpu.resident_mut(), window, Duration::ZERO)),
        }
    }

    /// See [`Renderer::update`].
    pub fn update(&mut self, budget: Duration) -> Progress {
        self.renderer().update(budget)
    }

    /// Pages that the last picture lacked; see `Resident::lacked`.
    pub fn lacked(&self) -> Vec<u32> {
        match self {
            Self::Gpu(gpu, _) => gpu.resident().lacked().to_vec(),
            Self::Cpu(cpu) => cpu.resident().lacked().to_vec(),
        }
    }

    /// Asks for pages again that an earlier picture lacked.
    pub fn ask(&mut self, pages: &[u32]) {
        let pages = pages.iter().copied();
        match self {
            Self::Gpu(gpu, _) => gpu.resident_mut().ask(pages),
            Self::Cpu(cpu) => cpu.resident_mut().ask(pages),
        };
    }

    /// How many of these pages are still to come.
    pub fn still_lacks(&self, pages: &[u32]) -> usize {
        match self {
            Self::Gpu(gpu, _) => gpu.resident().still_lacks(pages),
            Self::Cpu(cpu) => cpu.resident().still_lacks(pages),
        }
    }

    /// Tiles that cannot be read: how many, and why one of them.
    pub fn damaged(&self) -> (usize, Option<String>) {
        fn of<'a>(tiles: impl Iterator<Item = (TileKey, &'a FormatError)>) -> (usize, Option<String>) {
            tiles.fold((0, None), |(count, said), (_, error)| (count + 1, said.or_else(|| Some(error.to_string()))))
        }
        match self {
            Self::Gpu(gpu, _) => of(gpu.resident().damaged()),
            Self::Cpu(cpu) => of(cpu.resident().damaged()),
        }
    }

    /// What went wrong with the device outside any call; nothing can be drawn with it any more.
    ///
    /// # Errors
    /// See `Device::check`.
    pub fn check(&self) -> Result<(), DeviceError> {
        match self {
            Self::Gpu(gpu, _) => gpu.device().check(),
            Self::Cpu(_) => Ok(()),
        }
    }
}
