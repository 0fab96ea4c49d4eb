//! Messages of a viewer.

mod parse;

use serde::{Deserialize, Serialize};

use crate::view::View;

/// A message of a viewer, one JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ToServer {
    /// The first message.
    Hello(Hello),
    /// Makes a camera, or changes its planet and streams.
    Camera(Camera),
    /// What a camera looks at from now on. A view that was not drawn yet is forgotten.
    View(SetView),
    /// All payloads with this number have been received.
    Ack {
        /// The camera.
        camera: String,
        /// The number of the payloads.
        seq: u64,
    },
    /// Asks what a pixel of a camera's latest view shows.
    Pick(Pick),
    /// Ends a camera.
    Detach {
        /// The camera.
        camera: String,
    },
}

/// The first message.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// [`crate::VERSION`].
    pub version: u32,
    /// A name for the daemon's log.
    #[serde(default)]
    pub viewer: String,
    /// The daemon's token, where it has one and no header carried it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub token: Option<String>,
}

/// A camera and what is made of its pictures.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Camera {
    /// The viewer's name for it.
    pub camera: String,
    /// The planet's name.
    pub planet: String,
    /// Streams; at least one.
    #[serde(default)]
    pub streams: Streams,
}

/// What is made of a camera's pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Streams {
    /// The picture in colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    /// The visible part of the sun's disk at each pixel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<Mask>,
    /// The distance of each pixel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<Depth>,
    /// The triangles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<Mesh>,
}

impl Streams {
    /// How many payloads a picture has.
    #[must_use]
    pub fn count(&self) -> u32 {
        u32::from(self.frame.is_some())
            + u32::from(self.mask.is_some())
            + u32::from(self.depth.is_some())
            + u32::from(self.mesh.is_some())
    }
}

/// The stream `frame`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    /// How it is packed.
    #[serde(default)]
    pub format: FrameFormat,
    /// Of a JPEG, 1 to 100.
    #[serde(default = "default_quality")]
    pub quality: u8,
}

/// How a frame is packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrameFormat {
    /// Small and fast.
    #[default]
    Jpeg,
    /// Without loss.
    Png,
    /// RGBA, four bytes a pixel, rows from the top.
    Rgba,
}

/// The stream `mask`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mask {
    /// How it is packed.
    #[serde(default)]
    pub format: MaskFormat,
}

/// How a mask is packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MaskFormat {
    /// An 8-bit grey picture.
    #[default]
    Png,
    /// A byte a pixel, rows from the top.
    Raw,
}

/// The stream `depth`: f32, little-endian, metres from the camera, 0 in the sky, rows from the top.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Depth {}

/// The stream `mesh`: see [`crate::mesh`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mesh {}

/// What a camera looks at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetView {
    /// The camera.
    pub camera: String,
    /// The viewer's number for the view; payloads and faults name it.
    #[serde(default)]
    pub view: u64,
    /// The view.
    #[serde(flatten)]
    pub what: View,
}

/// A question about a pixel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pick {
    /// The camera.
    pub camera: String,
    /// The viewer's number for the question; the answer names it.
    #[serde(default)]
    pub id: u64,
    /// Pixels from the left edge; a pixel's centre lies at a half.
    pub x: f64,
    /// Pixels from the top.
    pub y: f64,
}

fn default_quality() -> u8 {
    80
}

impl Default for Frame {
    fn default() -> Self {
        Self { format: FrameFormat::default(), quality: default_quality() }
    }
}
