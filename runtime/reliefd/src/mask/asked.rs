//! What a mask is asked of: flags of `mask`, and with the same names the query of the daemon.

use relief_front::error::ToolError;
use relief_front::window::{Bounds, Rectangle, Samples};
use relief_runtime::planet::Planet;
use relief_runtime::view::SUN_RADIUS_DEG;

use crate::light::SunArgs;

/// A sun and the nodes that it shines on.
#[derive(Debug, clap::Args)]
pub struct MaskArgs {
    #[command(flatten)]
    pub sun: SunArgs,
    /// Level of the nodes; 0 is the finest
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub level: u32,
    /// Part of the map: degrees (a plane: CRS units); east may lie beyond the antimeridian
    #[arg(long, value_name = "W,S,E,N", allow_hyphen_values = true)]
    pub window: Option<Bounds>,
    /// Soft edges: the sun is a disk, not a point
    #[arg(long)]
    pub soft: bool,
    /// Density of the air that lifts the sun's light, 1 on Earth at sea level
    #[arg(long, value_name = "N", default_value_t = 0.0)]
    pub air: f32,
}

impl MaskArgs {
    /// The level's nodes and those among them that are asked for, the other flags checked.
    ///
    /// # Errors
    /// A level, a window or air that no mask can have.
    pub fn nodes(&self, planet: &Planet) -> Result<(Samples, Rectangle), ToolError> {
        let coarsest = planet.grid().root_level();
        if self.level > coarsest {
            return Err(ToolError::usage(
                format!("--level {}", self.level),
                format!("the file has the levels 0 (finest) to {coarsest}"),
                "ask for one of these levels; `relief-bake inspect` lists them",
            ));
        }
        let samples = Samples::of(planet.relief(), self.level, false);
        let bounds = self.window.unwrap_or_else(|| Bounds::whole(&samples)).ordered(samples.wraps)?;
        let rectangle = bounds.samples(&samples).ok_or_else(|| {
            ToolError::usage(
                format!("--window {},{},{},{}", bounds.west, bounds.south, bounds.east, bounds.north),
                "a window holds at least one node of the level",
                "widen it or give a finer --level; `relief-bake inspect` shows where the file lies",
            )
        })?;
        if !(0.0..=100.0).contains(&self.air) {
            let what = format!("--air {}", self.air);
            let remedy = "give --air 1, or leave it out";
            return Err(ToolError::usage(what, "a density is 0 to 100 times the Earth's", remedy));
        }
        Ok((samples, rectangle))
    }

    /// Radius of the sun's disk, degrees.
    pub fn radius_deg(&self) -> f64 {
        if self.soft { SUN_RADIUS_DEG } else { 0.0 }
    }
}

/// A mask that has no sun; `times` where a row of times may stand for it.
pub fn without_sun(planet: &Planet, times: bool) -> ToolError {
    let sun = match (planet.grid().plane, times) {
        (true, _) => "--sun AZIMUTH,ELEVATION",
        (false, true) => "--sun LON,LAT, --time TIME or --times FROM,TO,STEP",
        (false, false) => "--sun LON,LAT or --time TIME",
    };
    ToolError::usage("a mask without a sun", "shadows have a sun", format!("give {sun}"))
}
