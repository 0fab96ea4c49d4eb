//! What ways to a daemon have in common.

use std::time::{Duration, Instant};

use relief_protocol::to_server::ToServer;
use relief_protocol::to_viewer::ToViewer;

use crate::{AttachError, Event};

/// A way to a daemon.
pub(crate) trait Wire: Send {
    /// Sends a message, within the timeout of the options.
    fn send(&mut self, message: &ToServer) -> Result<(), AttachError>;

    /// The next thing that comes; none when the time is up.
    fn receive(&mut self, until: Instant) -> Result<Option<Event>, AttachError>;
}

/// The types of this version. Others are passed over: they may be added without a new version.
const TYPES: [&str; 7] = ["welcome", "planet", "picked", "error", "ring", "payload", "bye"];

/// Reads a message; none of a type that is not known here.
pub(crate) fn message(text: &str) -> Result<Option<ToViewer>, AttachError> {
    let error = match ToViewer::parse(text) {
        Ok(message) => return Ok(Some(message)),
        Err(error) => error,
    };
    let value = serde_json::from_str::<serde_json::Value>(text).unwrap_or_default();
    match value.get("type").and_then(serde_json::Value::as_str) {
        Some(kind) if !TYPES.contains(&kind) => Ok(None),
        _ => Err(AttachError::Foreign(format!("a message that cannot be read: {error}"))),
    }
}

/// Time that is left, as sockets take it: never zero, which would mean for ever.
pub(crate) fn left(until: Instant) -> Duration {
    until.saturating_duration_since(Instant::now()).max(Duration::from_millis(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_types_are_passed_over_and_broken_ones_are_not() {
        assert!(matches!(message(r#"{"type":"bye","reason":"r","more":1}"#), Ok(Some(ToViewer::Bye { .. }))));
        assert!(matches!(message(r#"{"type":"song"}"#), Ok(None)));
        for bad in [r#"{"type":"bye"}"#, "{}", "[]", "", r#"{"type":5}"#] {
            assert!(matches!(message(bad), Err(AttachError::Foreign(_))), "{bad}");
        }
    }
}
