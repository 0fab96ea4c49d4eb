//! Frames: what both backends make of a view.

mod error;
mod look;
mod paper;
mod picture;

use std::time::{Duration, Instant};

use relief_formats::tile::TileKey;
use relief_shaders::frame::Style;

use crate::residency::Progress;
use crate::view::{View, ViewError};

pub use error::RenderError;
pub use look::{sea_of, style_of};
pub(crate) use paper::{paper_map, refused};
pub use picture::Frame;
pub use relief_shaders::frame::{Fetches, Overlay, Shadow};
pub use relief_shaders::leb::{Corner, ReliefTriangle};

/// How a view is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// How relief becomes triangles.
    pub scheme: Scheme,
    /// What is drawn over the ground.
    pub overlay: Overlay,
    /// How shadows are found.
    pub shadow: Shadow,
    /// Density of the air that lifts the sun, 1 on Earth at sea level; 0 for no refraction.
    pub air: f32,
    /// Also fills [`Frame::places`].
    pub places: bool,
}

impl Settings {
    pub(crate) fn style(&self, look: &Style) -> Style {
        Style { overlay: self.overlay as u32, shadow: self.shadow as u32, air: self.air, ..*look }
    }

    /// Refuses what no kernel can draw with.
    pub(crate) fn check(&self) -> Result<(), ViewError> {
        match (0.0..=100.0).contains(&self.air) {
            true => Ok(()),
            false => Err(ViewError::Number { what: "density of the air", value: self.air.into(), rule: "0 to 100" }),
        }
    }
}

/// How relief becomes triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scheme {
    /// Longest-edge bisection, as exact as the view's threshold asks.
    #[default]
    Leb,
    /// The triangle patches of paper 000; its threshold is no bound of the error.
    Paper,
    /// All cells of a level, without adaptation or culling: the baseline.
    Uniform {
        /// The level.
        level: u32,
    },
}

/// What a frame cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// Triangles drawn.
    pub triangles: u64,
    /// Passes of the tessellation.
    pub passes: u32,
    /// Vertical triangles among those drawn (scheme `paper`).
    pub fillers: u64,
    /// Triangles that it judged.
    pub tested: u64,
    /// Triangles that it culled.
    pub culled: u64,
    /// True when its lists were too small even for this backend: the mesh has holes.
    pub overflow: bool,
    /// Pages in the atlas.
    pub tiles_resident: usize,
    /// Pages that the frame asked for and that are not there.
    pub tiles_missing: usize,
    /// What the shadows' rays fetched.
    pub fetches: Fetches,
    /// Milliseconds of each pass, in order; on a GPU by its own clock, where it has one.
    pub pass_ms: Vec<(&'static str, f64)>,
}

/// A backend with a resident set of one planet.
pub trait Renderer {
    /// Draws a view with what is resident; [`Stats::tiles_missing`] says whether that was all.
    ///
    /// # Errors
    /// A view that shows nothing, or what the device says.
    fn render(&mut self, view: &View, settings: &Settings) -> Result<Frame, RenderError>;

    /// The triangles of a view, from what is resident; see [`relief_shaders::position`] for where
    /// their corners are. In no order on a GPU.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    fn mesh(&mut self, view: &View, scheme: Scheme) -> Result<Vec<ReliefTriangle>, RenderError>;

    /// Loads what frames asked for, within a budget.
    fn update(&mut self, budget: Duration) -> Progress;

    /// Tiles that were asked for and cannot be read, each with the reason; coarser ones stand in.
    fn damaged(&self) -> Vec<(TileKey, String)>;

    /// Draws a view until nothing is missing, the time is over, or the atlas is full: then
    /// [`Stats::tiles_missing`] is above 0 and coarser tiles stand in.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    fn render_until_complete(
        &mut self,
        view: &View,
        settings: &Settings,
        time: Duration,
    ) -> Result<Frame, RenderError> {
        let deadline = Instant::now() + time;
        loop {
            let frame = self.render(view, settings)?;
            let left = deadline.saturating_duration_since(Instant::now());
            if frame.stats.tiles_missing == 0 || left.is_zero() {
                return Ok(frame);
            }
            let progress = self.update(left);
            if progress.full && progress.loaded == 0 {
                return Ok(frame);
            }
        }
    }
}
