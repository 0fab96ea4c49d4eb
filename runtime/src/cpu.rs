//! The backend without a GPU: the kernels' twins over `rayon`.

use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_formats::tile::TileKey;
use relief_shaders::frame::{self, Maps, Style};
use relief_shaders::leb::{self, ReliefTriangle};
use relief_shaders::shadow::paper::PaperMap;
use relief_shaders::{paper, planet as shared};

use crate::frame::{Frame, RenderError, Renderer, Scheme, Settings, Shadow, Stats, paper_map, sea_of, style_of};
use crate::planet::Planet;
use crate::residency::{Capacity, Progress, Ram, Resident};
use crate::view::{View, ViewError};

/// Pixels a picture may have: as many as its buffers can count.
const MOST_PIXELS: u64 = 1 << 28;
/// Triangles of a mesh or of a pass.
const MOST_TRIANGLES: u32 = 1 << 26;

/// A planet in RAM.
pub struct Cpu {
    resident: Resident<Ram>,
    style: Style,
    sea_m: Vec<f32>,
    /// Made when a frame first asks for it.
    paper: Option<PaperMap>,
}

impl Cpu {
    /// A resident set of up to `atlas_bytes`.
    ///
    /// # Errors
    /// [`RenderError::Capacity`], [`RenderError::File`].
    pub fn new(planet: Arc<Planet>, atlas_bytes: u64) -> Result<Self, RenderError> {
        let capacity = Capacity::within(atlas_bytes, u64::MAX)?;
        let style = style_of(&planet)?;
        let sea_m = sea_of(&planet);
        Ok(Self { paper: None, sea_m, resident: Resident::new(planet, capacity, Ram::new(capacity))?, style })
    }

    /// The resident set.
    #[must_use]
    pub fn resident(&self) -> &Resident<Ram> {
        &self.resident
    }

    /// The resident set, for twins that are run on it.
    pub fn resident_mut(&mut self) -> &mut Resident<Ram> {
        &mut self.resident
    }

    /// The mesh of a view, from what is resident, and what it cost.
    fn tessellate(&self, view: &shared::View, scheme: Scheme) -> (Vec<ReliefTriangle>, Stats) {
        let pages = self.resident.pages();
        let params = || leb::Params::new(pages.planet, view, MOST_TRIANGLES, MOST_TRIANGLES);
        match scheme {
            Scheme::Leb => {
                let leb::Mesh { triangles, stats: leb::Stats { passes, tested, culled, overflow } } =
                    leb::tessellate(&pages, view, &params());
                let [tested, culled] = [tested, culled].map(u64::from);
                (triangles, Stats { passes, tested, culled, overflow, ..Stats::default() })
            }
            Scheme::Paper => {
                let paper::Drawn { triangles, stats } = paper::tessellate(&pages, view, &params());
                let [tested, culled, fillers] = [stats.tested, stats.culled, stats.fillers].map(u64::from);
                let (passes, overflow) = (stats.passes, stats.overflow);
                (triangles, Stats { passes, tested, culled, fillers, overflow, ..Stats::default() })
            }
            Scheme::Uniform { level } => {
                let triangles = frame::uniform(&pages, level.min(pages.planet.root_level));
                let tested = triangles.len() as u64;
                (triangles, Stats { passes: 1, tested, ..Stats::default() })
            }
        }
    }
}

impl Renderer for Cpu {
    fn render(&mut self, view: &View, settings: &Settings) -> Result<Frame, RenderError> {
        let (width, height) = (view.width, view.height);
        if u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(ViewError::Size { width, height, limit: Some(1 << 14) }.into());
        }
        let uniform = view.uniform(self.resident.planet())?;
        settings.check()?;
        settings.check_kernel(self.resident.planet().grid())?;
        if settings.shadow == Shadow::Paper && self.paper.is_none() {
            self.paper = Some(paper_map(self.resident.planet())?);
        }
        let style = settings.style(&self.style);
        let mut clock = Clock(Instant::now());
        let (triangles, mut stats) = self.tessellate(&uniform, settings.scheme);
        stats.pass_ms.push(("tessellate", clock.lap_ms()));
        let maps = Maps { sea_m: &self.sea_m, paper: self.paper.as_ref() };
        let places = frame::draw(self.resident.uniform(), &uniform, &triangles);
        stats.pass_ms.push(("draw", clock.lap_ms()));
        let (shaded, fetches) = frame::shade(&self.resident.pages(), &uniform, &style, maps, &places);
        stats.pass_ms.push(("shade", clock.lap_ms()));
        stats.triangles = triangles.len() as u64;
        stats.fetches = fetches;
        stats.tiles_missing = self.resident.ask_seen();
        stats.tiles_resident = self.resident.count();
        let frame = Frame::new([width, height], shaded, stats);
        Ok(if settings.places { frame.with_places(&places) } else { frame })
    }

    fn mesh(&mut self, view: &View, scheme: Scheme) -> Result<Vec<ReliefTriangle>, RenderError> {
        let view = view.uniform(self.resident.planet())?;
        let (triangles, _) = self.tessellate(&view, scheme);
        self.resident.ask_seen();
        Ok(triangles)
    }

    fn update(&mut self, budget: Duration) -> Progress {
        self.resident.update(budget)
    }

    fn damaged(&self) -> Vec<(TileKey, String)> {
        self.resident.damaged().map(|(key, error)| (key, error.to_string())).collect()
    }
}

struct Clock(Instant);

impl Clock {
    fn lap_ms(&mut self) -> f64 {
        let now = Instant::now();
        let lap = now - std::mem::replace(&mut self.0, now);
        lap.as_secs_f64() * 1e3
    }
}
