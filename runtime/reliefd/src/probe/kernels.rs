//! Height and sunlight at points, by the backend's kernels.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;
use relief_front::error::ToolError;
use relief_runtime::cpu::Cpu;
use relief_runtime::gpu::{Gpu, Heights, ShadowPoints};
use relief_runtime::planet::Planet;
use relief_runtime::shadow::{PointSun, SunlitPoints, points_in_ram};

use crate::backend::Backend;
use crate::errors::{of_device, of_render};

/// Memory for tiles.
const ATLAS_BYTES: u64 = 512 << 20;
/// Longest wait for the tiles of one part of the points.
const WAIT: Duration = Duration::from_secs(600);
/// Most points of a part.
const PART: usize = 1 << 16;

/// A height in metres, and the visible part of the sun where there is one.
pub type Known = (f32, Option<f32>);

/// Answers points.
pub struct Kernels {
    path: PathBuf,
    backend: On,
    /// Points of a part: fewer once the tiles of one did not fit.
    part: usize,
}

enum On {
    Gpu(Box<Gpu>, Heights, ShadowPoints),
    /// Their twins.
    Cpu(Box<Cpu>),
}

impl Kernels {
    /// On a backend, for the planet of the file at `path`.
    pub fn new(backend: &Backend, planet: Arc<Planet>, path: &Path) -> Result<Self, ToolError> {
        Self::within(ATLAS_BYTES, backend, planet, path)
    }

    fn within(atlas_bytes: u64, backend: &Backend, planet: Arc<Planet>, path: &Path) -> Result<Self, ToolError> {
        let failed = of_render(path);
        let backend = match backend {
            Backend::Gpu(device) => {
                let gpu = Gpu::new(device, planet, atlas_bytes).map_err(failed)?;
                let heights = Heights::new(device).map_err(of_device)?;
                On::Gpu(Box::new(gpu), heights, ShadowPoints::new(device).map_err(of_device)?)
            }
            Backend::Cpu => On::Cpu(Box::new(Cpu::new(planet, atlas_bytes).map_err(failed)?)),
        };
        Ok(Self { path: path.to_path_buf(), backend, part: PART })
    }

    /// What is known of fixed-point places at a level, with a sun over that level if there is one.
    /// Neighbours in the list should be neighbours on the map: they share tiles.
    ///
    /// # Errors
    /// Tiles that cannot be read or do not fit the memory, or a device that gave up.
    pub fn at(&mut self, level: u32, sun: Option<&PointSun>, places: &[[u32; 2]]) -> Result<Vec<Known>, ToolError> {
        let mut known = Vec::with_capacity(places.len());
        while known.len() < places.len() {
            let rest = &places[known.len()..];
            let part = &rest[..self.part.min(rest.len())];
            let (answers, lacking) = self.once(level, sun, part)?;
            if let Some((_, error)) = self.damage() {
                let words = error.to_string();
                // A tile that the kernels lack; its error belongs to the set of tiles.
                let error = FormatError::Damaged(words.trim_start_matches("damaged file: ").to_owned());
                return Err(ToolError::of_file(&self.path)(error));
            }
            if lacking == 0 {
                known.extend(answers);
            } else if part.len() > 1 {
                self.part = part.len().div_ceil(2);
            } else {
                return Err(ToolError::usage(
                    format!("{lacking} tiles that a point at level {level} needs are not at hand"),
                    format!("the tiles of a point and its ray come within {} s and fit the memory", WAIT.as_secs()),
                    "give a coarser --level, or check the file with `relief-bake validate`",
                ));
            }
        }
        Ok(known)
    }

    fn once(
        &mut self,
        level: u32,
        sun: Option<&PointSun>,
        places: &[[u32; 2]],
    ) -> Result<(Vec<Known>, usize), ToolError> {
        let lit = |SunlitPoints { points, lacking }: SunlitPoints| {
            (points.iter().map(|point| (point.height_m, Some(point.visible))).collect(), lacking)
        };
        let unlit = |(heights_m, lacking): (Vec<f32>, usize)| {
            (heights_m.into_iter().map(|height_m| (height_m, None)).collect(), lacking)
        };
        Ok(match (&mut self.backend, sun) {
            (On::Gpu(gpu, _, points), Some(sun)) => {
                lit(points.at(gpu.resident_mut(), sun, places, WAIT).map_err(of_device)?)
            }
            (On::Gpu(gpu, heights, _), None) => {
                unlit(heights.at(gpu.resident_mut(), level, places, WAIT).map_err(of_device)?)
            }
            (On::Cpu(cpu), Some(sun)) => lit(points_in_ram(cpu.resident_mut(), sun, places, WAIT)),
            (On::Cpu(cpu), None) => unlit(heights_in_ram(cpu, level, places)),
        })
    }

    /// Damage that the last points met.
    fn damage(&self) -> Option<(TileKey, &FormatError)> {
        match &self.backend {
            On::Gpu(gpu, ..) => gpu.resident().damage_met(),
            On::Cpu(cpu) => cpu.resident().damage_met(),
        }
    }
}

/// Heights, and how many pages lacked to the end.
fn heights_in_ram(cpu: &mut Cpu, level: u32, places: &[[u32; 2]]) -> (Vec<f32>, usize) {
    let deadline = Instant::now() + WAIT;
    loop {
        let pages = cpu.resident().pages();
        let heights_m = places.iter().map(|&[s, t]| pages.height_m(level, s, t)).collect();
        let lacking = cpu.resident_mut().ask_seen();
        if lacking == 0 || !cpu.resident_mut().load_more(deadline) {
            return (heights_m, lacking);
        }
    }
}

#[cfg(test)]
mod tests;
