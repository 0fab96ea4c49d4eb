//! A message as text, read and checked: nothing that no daemon can do comes through.

use super::{Camera, Frame, Pick, SetView, ToServer};
use crate::error::{Code, Fault};
use crate::{MOST_MESSAGE_BYTES, MOST_NAME_BYTES};

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
mod tests;
