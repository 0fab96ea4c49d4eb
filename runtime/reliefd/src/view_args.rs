//! A view in words: flags of `render`, and with the same names the queries of the daemon.

use relief_front::error::ToolError;
use relief_runtime::frame::{Overlay, Scheme, Settings, Shadow};
use relief_runtime::planet::Planet;
use relief_runtime::view::{Camera, SUN_RADIUS_DEG, View};

use crate::errors::of_view;
use crate::light::{Light, SunArgs};
use crate::typed::{CameraArg, SizeArg};

/// What is looked at, and how.
#[derive(Debug, clap::Args)]
pub struct ViewArgs {
    /// Where the camera is and which way it looks (a plane: X,Y,HEIGHT,...); degrees and metres
    #[arg(long, value_name = "LON,LAT,HEIGHT[,HEADING,PITCH,ROLL]", allow_hyphen_values = true)]
    pub camera: CameraArg,
    /// Vertical field of view, degrees
    #[arg(long, value_name = "DEG", default_value_t = 60.0)]
    pub fov: f64,
    /// Pixels of the picture
    #[arg(long, value_name = "WxH", default_value = "1920x1080")]
    pub size: SizeArg,
    #[command(flatten)]
    pub sun: SunArgs,
    /// Pixels by which the drawn surface may be away from the true one
    #[arg(long, value_name = "N", default_value_t = 1.0)]
    pub pixel_error: f32,
    /// How relief becomes triangles
    #[arg(long, value_name = "SCHEME", value_enum, default_value = "leb")]
    pub scheme: SchemeChoice,
    /// How shadows are found
    #[arg(long, value_name = "KERNEL", value_enum, default_value = "exact")]
    pub shadow: ShadowChoice,
    /// Density of the air that lifts the sun's light, 1 on Earth at sea level
    #[arg(long, value_name = "N", default_value_t = 0.0)]
    pub air: f32,
    /// Soft edges of shadows: the sun is a disk, not a point
    #[arg(long)]
    pub soft: bool,
    /// What is drawn over the ground
    #[arg(long, value_name = "WHAT", value_enum)]
    pub overlay: Option<OverlayChoice>,
}

/// How relief becomes triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SchemeChoice {
    /// Longest-edge bisection: within --pixel-error, everywhere
    Leb,
    /// The triangle patches of paper 000: --pixel-error is a wish
    Paper,
}

/// How shadows are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ShadowChoice {
    /// Rays to the sun, above the curved body
    Exact,
    /// The paper's rays, a baseline: planes of at most 8192 x 8192 nodes
    Paper,
    /// None
    None,
}

/// What is drawn over the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum OverlayChoice {
    /// The triangles' sides
    Wireframe,
    /// The triangles' sides and a colour for each level of detail
    Lod,
    /// A colour for each page that heights are from, by level; striped where a coarser one stands in
    Pages,
    /// The error really drawn: blue none, white --pixel-error, red twice that; striped where the
    /// finest heights are not at hand
    Error,
}

impl SchemeChoice {
    /// As it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Leb => "leb",
            Self::Paper => "paper",
        }
    }
}

impl ViewArgs {
    /// The view of a planet, checked.
    ///
    /// # Errors
    /// A camera, a sun or a number that shows nothing of this planet.
    pub fn view(&self, planet: &Planet) -> Result<View, ToolError> {
        self.lit_view(planet).map(|(view, _)| view)
    }

    /// The same, and where its sun stands: sub-solar longitude and latitude, or azimuth and
    /// elevation, degrees.
    ///
    /// # Errors
    /// As [`Self::view`].
    pub fn lit_view(&self, planet: &Planet) -> Result<(View, [f64; 2]), ToolError> {
        let CameraArg { x, y, height_m, turned_deg: [heading, pitch, roll] } = self.camera;
        let placed = if planet.grid().plane {
            Camera::over_plane(planet, x, y, height_m)
        } else {
            Camera::over_globe(x, y, height_m)
        };
        let camera = placed.map_err(of_view)?.looking(heading, pitch, roll).with_fov(self.fov);
        let light = match self.sun.light(planet)? {
            Some(light) => light,
            None => Light::of_maps(planet, &camera)?,
        };
        let view = View {
            sun_radius_deg: if self.soft { SUN_RADIUS_DEG } else { 0.0 },
            pixel_error: self.pixel_error,
            ..View::new(camera, self.size.0, light.sun)
        };
        view.uniform(planet).map_err(of_view)?;
        Ok((view, light.angles_deg))
    }

    /// How it is drawn.
    pub fn settings(&self) -> Settings {
        let scheme = match self.scheme {
            SchemeChoice::Leb => Scheme::Leb,
            SchemeChoice::Paper => Scheme::Paper,
        };
        let overlay = match self.overlay {
            None => Overlay::None,
            Some(OverlayChoice::Wireframe) => Overlay::Wireframe,
            Some(OverlayChoice::Lod) => Overlay::Detail,
            Some(OverlayChoice::Pages) => Overlay::Pages,
            Some(OverlayChoice::Error) => Overlay::Error,
        };
        let shadow = match self.shadow {
            ShadowChoice::Exact => Shadow::Exact,
            ShadowChoice::Paper => Shadow::Paper,
            ShadowChoice::None => Shadow::None,
        };
        Settings { scheme, overlay, shadow, air: self.air, places: false }
    }
}
