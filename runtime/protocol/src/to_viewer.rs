//! Messages of the daemon. Payloads come beside them: see [`crate::payload`].

use serde::{Deserialize, Serialize};

use crate::error::Fault;

/// A message of the daemon, one JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ToViewer {
    /// The answer to the hello.
    Welcome(Welcome),
    /// A planet's file was replaced: its cameras are drawn anew.
    Planet(Planet),
    /// What a pixel shows.
    Picked(Picked),
    /// Something is wrong.
    Error(Fault),
    /// Shared memory for a camera's payloads; comes with a file descriptor (local viewers only).
    Ring(Ring),
    /// A payload lies in a ring (local viewers only).
    Payload(InRing),
    /// The daemon ends the connection, for no fault of the viewer.
    Bye {
        /// Why.
        reason: String,
    },
}

/// The answer to the hello.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Welcome {
    /// [`crate::VERSION`].
    pub version: u32,
    /// Name and version of the daemon.
    pub server: String,
    /// The daemon's number for this viewer.
    pub viewer: u64,
    /// The planets that can be looked at.
    pub planets: Vec<Planet>,
    /// What a viewer may ask for.
    pub limits: Limits,
}

/// What a viewer may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Bytes of a message.
    pub message_bytes: usize,
    /// Cameras of a viewer.
    pub cameras: usize,
    /// Pixels of a view.
    pub pixels: u64,
    /// Pictures of a camera that may be unacknowledged.
    pub unacknowledged: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            message_bytes: crate::MOST_MESSAGE_BYTES,
            cameras: crate::MOST_CAMERAS,
            pixels: crate::MOST_PIXELS,
            unacknowledged: crate::MOST_UNACKNOWLEDGED,
        }
    }
}

/// A planet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Planet {
    /// The file's stem.
    pub name: String,
    /// The body: its name, or `plane`.
    pub body: String,
    /// True for a plane: places are X, Y and the sun is azimuth, elevation.
    pub plane: bool,
    /// Equatorial semi-axis, metres; none for a plane.
    pub a_m: Option<f64>,
    /// Polar semi-axis, metres; none for a plane.
    pub b_m: Option<f64>,
    /// West, south, east and north edge: degrees, or units of the CRS.
    pub bounds: [f64; 4],
    /// Metres in a unit of the CRS along X and Y; none for a globe.
    pub metres_per_unit: Option<[f64; 2]>,
    /// True where the sun can be named by a time.
    pub has_time: bool,
    /// The grid is 2^(m+1) x 2^m (a plane: 2^m x 2^m).
    pub m: u32,
    /// Metres between the finest nodes along a meridian (a plane: northwards).
    pub spacing_m: f64,
    /// Lowest height, metres.
    pub min_m: f64,
    /// Highest height, metres.
    pub max_m: f64,
    /// Hash of the heights, in hexadecimal digits.
    pub content_id: String,
    /// What draws it: adapter and driver, or the CPU.
    pub backend: String,
}

/// The answer to a pick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Picked {
    /// The camera.
    pub camera: String,
    /// The viewer's number of the question.
    pub id: u64,
    /// What is there; none in the sky.
    pub place: Option<Place>,
}

/// A place on the relief.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Longitude (degrees) or X.
    pub x: f64,
    /// Latitude (degrees) or Y.
    pub y: f64,
    /// Height of the relief, metres.
    pub height_m: f64,
    /// Metres from the camera.
    pub distance_m: f64,
    /// The sun above the local horizon, degrees, relief and refraction left out.
    pub sun_elevation_deg: f64,
    /// Its azimuth, clockwise from north, degrees.
    pub sun_azimuth_deg: f64,
    /// Visible part of the sun's disk, 0 to 1; none without shadows.
    pub lit: Option<f64>,
}

/// Shared memory for a camera's payloads: see [`crate::ring`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ring {
    /// The camera.
    pub camera: String,
    /// Slots.
    pub slots: u32,
    /// Bytes of a slot.
    pub slot_bytes: u64,
    /// Bytes of the whole.
    pub bytes: u64,
}

/// A payload in a ring.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InRing {
    /// The camera.
    pub camera: String,
    /// The slot.
    pub slot: u32,
    /// The slot's sequence number while it holds this payload.
    pub sequence: u64,
    /// Bytes of the envelope and the payload.
    pub bytes: u64,
}

impl ToViewer {
    /// Reads a message.
    ///
    /// # Errors
    /// What serde_json says: a daemon of another version.
    pub fn parse(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
    }

    /// As text.
    #[must_use]
    pub fn text(&self) -> String {
        // Numbers that are not finite become null; nothing else can fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}
