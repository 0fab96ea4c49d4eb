//! What a camera looks at.

use serde::{Deserialize, Serialize};

use crate::MOST_PIXELS;
use crate::error::{Code, Fault};

/// A view; the names and meanings are those of `reliefd render`'s flags.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Longitude, latitude (degrees; a plane: X, Y of its CRS), height above the ellipsoid or the
    /// plane (metres), then heading (0), pitch (-90) and roll (0), degrees, which may be left out.
    pub pose: Vec<f64>,
    /// Vertical field of view, degrees.
    #[serde(default = "default_fov")]
    pub fov: f64,
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// The sub-solar point, geodetic degrees (a plane: azimuth and elevation).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sun: Option<[f64; 2]>,
    /// The time of the sun, RFC 3339, over the Earth. Without `sun` and `time` the light comes from
    /// the north-west, 45 degrees high.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// Pixels by which the drawn surface may be away from the true one.
    #[serde(default = "default_pixel_error")]
    pub pixel_error: f32,
    /// How relief becomes triangles.
    #[serde(default)]
    pub scheme: Scheme,
    /// How shadows are found.
    #[serde(default)]
    pub shadow: Shadow,
    /// Soft edges of shadows.
    #[serde(default)]
    pub soft: bool,
    /// Density of the air that lifts the sun's light, 1 on Earth at sea level.
    #[serde(default)]
    pub air: f32,
    /// What is drawn over the ground.
    #[serde(default)]
    pub overlay: Overlay,
}

/// How relief becomes triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Longest-edge bisection, within `pixel_error` everywhere.
    #[default]
    Leb,
    /// The triangle patches of paper 000.
    Paper,
}

/// How shadows are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shadow {
    /// Rays to the sun above the curved body.
    #[default]
    Exact,
    /// The paper's rays, a baseline: planes of at most 8192 x 8192 nodes.
    Paper,
    /// None.
    None,
}

/// What is drawn over the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The triangles' sides.
    Wireframe,
    /// The triangles' sides and a colour for each level of detail.
    Lod,
    /// The page of the atlas that each pixel's height comes from.
    Pages,
    /// How far the drawn surface is from the true one, in pixels.
    Error,
}

fn default_fov() -> f64 {
    60.0
}

fn default_pixel_error() -> f32 {
    1.0
}

impl View {
    /// A view straight down with north up.
    #[must_use]
    pub fn down(pose: [f64; 3], size: [u32; 2]) -> Self {
        Self {
            pose: pose.to_vec(),
            fov: default_fov(),
            size,
            sun: None,
            time: None,
            pixel_error: default_pixel_error(),
            scheme: Scheme::default(),
            shadow: Shadow::default(),
            soft: false,
            air: 0.0,
            overlay: Overlay::default(),
        }
    }

    /// Refuses what shows nothing of any planet.
    ///
    /// # Errors
    /// [`Code::BadView`] or [`Code::TooLarge`].
    pub fn check(&self) -> Result<(), Fault> {
        let bad = |what: String, rule: &str, remedy: &str| Err(Fault::new(Code::BadView, what, rule, remedy));
        if !(3..=6).contains(&self.pose.len()) || self.pose.iter().any(|v| !v.is_finite()) {
            return bad(
                format!("a pose of {:?}", self.pose),
                "a pose is longitude, latitude and height, then heading, pitch and roll if they are given; all finite",
                "send 3 to 6 numbers",
            );
        }
        if self.sun.is_some() && self.time.is_some() {
            return bad("a sun and a time".into(), "the sun is named by its place or by a time", "leave one out");
        }
        let [width, height] = self.size;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 {
            return bad(format!("a size of {width} x {height}"), "a picture has pixels", "ask for at least 1 x 1");
        }
        if pixels > MOST_PIXELS {
            return Err(Fault::new(
                Code::TooLarge,
                format!("a size of {width} x {height}: {pixels} pixels"),
                format!("a view has at most {MOST_PIXELS} pixels"),
                "ask for a smaller picture",
            ));
        }
        Ok(())
    }

    /// Longitude, latitude, height, heading, pitch and roll of a view that was checked.
    #[must_use]
    pub fn six(&self) -> [f64; 6] {
        let given = |k: usize, default| self.pose.get(k).copied().unwrap_or(default);
        [given(0, 0.0), given(1, 0.0), given(2, 0.0), given(3, 0.0), given(4, -90.0), given(5, 0.0)]
    }
}
