//! Where the kernels run.

use std::path::Path;
use std::sync::Arc;

use relief_front::error::ToolError;
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::Renderer;
use relief_runtime::gpu::{AdapterChoice, Device, DeviceError, Gpu};
use relief_runtime::planet::Planet;

use crate::errors::{of_device, of_render};

/// Where the kernels run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum BackendChoice {
    /// The GPU where there is one, else the CPU
    #[default]
    Auto,
    /// The GPU, or not at all
    Gpu,
    /// The kernels' twins on all cores
    Cpu,
}

/// Most memory for tiles.
pub const ATLAS_BYTES: u64 = 1 << 30;

/// A backend that was found.
pub enum Backend {
    /// A device.
    Gpu(Device),
    /// All cores.
    Cpu,
}

impl Backend {
    /// The backend that was asked for.
    pub fn find(choice: BackendChoice) -> Result<Self, ToolError> {
        match choice {
            BackendChoice::Cpu => Ok(Self::Cpu),
            BackendChoice::Gpu => Ok(Self::Gpu(Device::headless(AdapterChoice::Fastest).map_err(of_device)?)),
            BackendChoice::Auto => match Device::headless(AdapterChoice::Fastest) {
                // A GPU in software is slower than the twins on the same cores.
                Ok(device) if device.info().device_type == wgpu::DeviceType::Cpu => Ok(Self::Cpu),
                Ok(device) => Ok(Self::Gpu(device)),
                Err(DeviceError::NoAdapter(_)) => Ok(Self::Cpu),
                Err(error) => Err(of_device(error)),
            },
        }
    }

    /// Adapter and driver, or the CPU.
    pub fn name(&self) -> String {
        match self {
            Self::Gpu(device) => {
                let info = device.info();
                format!("{} ({}, {} {})", info.name, info.backend, info.driver, info.driver_info)
            }
            Self::Cpu => format!("CPU, {} threads", std::thread::available_parallelism().map_or(1, usize::from)),
        }
    }

    /// A renderer of a planet from the file at `path`.
    pub fn renderer(&self, planet: Arc<Planet>, path: &Path) -> Result<Box<dyn Renderer>, ToolError> {
        let failed = of_render(path);
        Ok(match self {
            Self::Gpu(device) => Box::new(Gpu::new(device, planet, ATLAS_BYTES).map_err(failed)?),
            Self::Cpu => Box::new(Cpu::new(planet, ATLAS_BYTES).map_err(failed)?),
        })
    }
}
