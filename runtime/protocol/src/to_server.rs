//! Messages of a viewer.

use serde::{Deserialize, Serialize};

use crate::error::{Code, Fault};
use crate::view::View;
use crate::{MOST_MESSAGE_BYTES, MOST_NAME_BYTES};

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

impl ToServer {
    /// Reads a message, and refuses what no daemon can do.
    ///
    /// # Errors
    /// [`Code::Malformed`], [`Code::TooLarge`], [`Code::BadView`].
    pub fn parse(text: &str) -> Result<Self, Fault> {
        let malformed = |what: String, remedy: &str| {
            Fault::new(Code::Malformed, what, "a message is one JSON object as PROTOCOL.md describes it", remedy)
        };
        if text.len() > MOST_MESSAGE_BYTES {
            return Err(Fault::new(
                Code::TooLarge,
                format!("a message of {} bytes", text.len()),
                format!("a message has at most {MOST_MESSAGE_BYTES} bytes"),
                "send less in one message",
            ));
        }
        let message: Self = serde_json::from_str(text)
            .map_err(|error| malformed(error.to_string(), "send an object with a known \"type\" and its fields"))?;
        message.check()?;
        Ok(message)
    }

    /// As text.
    #[must_use]
    pub fn text(&self) -> String {
        // Numbers that are not finite become null; nothing else can fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// The camera it is about.
    #[must_use]
    pub fn camera(&self) -> Option<&str> {
        match self {
            Self::Hello(_) => None,
            Self::Camera(Camera { camera, .. })
            | Self::View(SetView { camera, .. })
            | Self::Ack { camera, .. }
            | Self::Pick(Pick { camera, .. })
            | Self::Detach { camera } => Some(camera),
        }
    }

    fn check(&self) -> Result<(), Fault> {
        let bad = |what: String, rule: &str, remedy: &str| Err(Fault::new(Code::Malformed, what, rule, remedy));
        if let Some(name) = self.camera()
            && (name.is_empty() || name.len() > MOST_NAME_BYTES)
        {
            return bad(
                format!("a camera's name of {} bytes", name.len()),
                "a camera's name has 1 to 64 bytes",
                "name the camera",
            );
        }
        match self {
            Self::Camera(Camera { streams, camera, .. }) => {
                if streams.count() == 0 {
                    return bad(
                        format!("the camera {camera:?} without streams"),
                        "a camera has a stream: frame, mask, depth or mesh",
                        "ask for one, such as \"streams\":{\"frame\":{}}",
                    );
                }
                match streams.frame {
                    Some(Frame { quality, .. }) if !(1..=100).contains(&quality) => {
                        bad(format!("a quality of {quality}"), "a quality is 1 to 100", "send 80, or leave it out")
                    }
                    _ => Ok(()),
                }
            }
            Self::View(SetView { camera, view, what }) => what.check().map_err(|fault| fault.of(camera).at(*view)),
            Self::Pick(Pick { x, y, camera, .. }) if !(x.is_finite() && y.is_finite()) => {
                bad(format!("a pixel at {x}, {y}"), "a pixel is named by finite numbers", "send x and y")
                    .map_err(|f: Fault| f.of(camera))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn messages_are_read() {
        let text = r#"{"type":"view","camera":"main","view":3,"pose":[85,19,6e5,5,-38],"size":[640,360],"sun":[4,15],"overlay":"lod"}"#;
        let Ok(ToServer::View(SetView { view: 3, what, .. })) = ToServer::parse(text) else { panic!("{text}") };
        assert_eq!(what.six(), [85.0, 19.0, 6e5, 5.0, -38.0, 0.0]);
        let hello = ToServer::parse(r#"{"type":"hello","version":1,"colour":"red"}"#);
        assert_eq!(hello, Ok(ToServer::Hello(Hello { version: 1, viewer: String::new(), token: None })));
        let camera = r#"{"type":"camera","camera":"a","planet":"earth","streams":{"frame":{"quality":50},"mesh":{}}}"#;
        let Ok(ToServer::Camera(Camera { streams, .. })) = ToServer::parse(camera) else { panic!("{camera}") };
        assert_eq!((streams.count(), streams.frame.map(|f| f.quality)), (2, Some(50)));
    }

    #[test]
    fn bad_messages_say_what_is_wrong() {
        let pose = |pose: &str, rest: &str| format!(r#"{{"type":"view","camera":"c","view":9,"pose":{pose},{rest}}}"#);
        for (text, code) in [
            (String::new(), Code::Malformed),
            ("[]".into(), Code::Malformed),
            (r#"{"type":"fly"}"#.into(), Code::Malformed),
            (r#"{"type":"hello","version":-1}"#.into(), Code::Malformed),
            (r#"{"type":"detach","camera":""}"#.into(), Code::Malformed),
            (format!(r#"{{"type":"detach","camera":"{}"}}"#, "x".repeat(65)), Code::Malformed),
            (r#"{"type":"camera","camera":"a","planet":"p"}"#.into(), Code::Malformed),
            (
                r#"{"type":"camera","camera":"a","planet":"p","streams":{"frame":{"quality":0}}}"#.into(),
                Code::Malformed,
            ),
            (r#"{"type":"pick","camera":"a","x":1e999,"y":0}"#.into(), Code::Malformed),
            (pose("[1,2]", r#""size":[8,8]"#), Code::BadView),
            (pose("[1,2,NaN]", r#""size":[8,8]"#), Code::Malformed),
            (pose("[1,2,3]", r#""size":[0,8]"#), Code::BadView),
            (pose("[1,2,3]", r#""size":[8,8],"sun":[0,0],"time":"2026-06-21T00:00:00Z""#), Code::BadView),
            (pose("[1,2,3]", r#""size":[4000000000,4000000000]"#), Code::TooLarge),
            (" ".repeat(MOST_MESSAGE_BYTES + 1), Code::TooLarge),
        ] {
            let fault = ToServer::parse(&text).unwrap_err();
            assert_eq!(fault.code, code, "{text:.80} {fault}");
        }
        let fault = ToServer::parse(&pose("[1,2]", r#""size":[8,8]"#)).unwrap_err();
        assert_eq!((fault.camera.as_deref(), fault.view), (Some("c"), Some(9)));
    }

    proptest! {
        #[test]
        fn no_text_ends_in_a_panic(text in ".{0,200}", at in 0usize..200, byte in any::<char>()) {
            let _ = ToServer::parse(&text);
            let good = r#"{"type":"view","camera":"main","view":3,"pose":[85,19,600000.0],"fov":60.0,"size":[640,360]}"#;
            let bent: String = good.chars().enumerate().map(|(k, c)| if k == at { byte } else { c }).collect();
            if let Ok(message) = ToServer::parse(&bent) {
                prop_assert_eq!(ToServer::parse(&message.text()), Ok(message));
            }
        }
    }
}
