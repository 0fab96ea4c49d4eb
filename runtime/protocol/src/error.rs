//! What a viewer is told when something is wrong.

use serde::{Deserialize, Serialize};

/// Kinds of faults; stable words, for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// A message that cannot be read, or comes at the wrong time: the viewer's author.
    Malformed,
    /// A version of the protocol that this daemon does not speak.
    Version,
    /// A message, a picture or a number of cameras beyond the limits of the welcome.
    TooLarge,
    /// A name that no planet or camera has.
    Unknown,
    /// A view that shows nothing of this planet.
    BadView,
    /// No token, or a wrong one.
    Token,
    /// A web page of another site, or by a name that is not the daemon's.
    Origin,
    /// As many viewers as the daemon takes are attached.
    Busy,
    /// The viewer said nothing for too long, or does not read.
    Timeout,
    /// A tile of the planet's file is damaged; a coarser one stands in.
    Damaged,
    /// The GPU was lost or is out of memory; the daemon makes it anew.
    Device,
    /// The daemon's own fault.
    Internal,
}

/// A fault in words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// Its kind.
    pub code: Code,
    /// The value that was found.
    pub what: String,
    /// What it must satisfy.
    pub rule: String,
    /// What to do about it.
    pub remedy: String,
    /// The camera it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
    /// The view it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<u64>,
    /// True when the connection ends with it.
    #[serde(default)]
    pub fatal: bool,
}

impl Fault {
    /// A fault that leaves the connection as it is.
    pub fn new(code: Code, what: impl Into<String>, rule: impl Into<String>, remedy: impl Into<String>) -> Self {
        let (what, rule, remedy) = (what.into(), rule.into(), remedy.into());
        Self { code, what, rule, remedy, camera: None, view: None, fatal: false }
    }

    /// The same, ending the connection.
    #[must_use]
    pub fn fatal(self) -> Self {
        Self { fatal: true, ..self }
    }

    /// The same, about a camera.
    #[must_use]
    pub fn of(self, camera: &str) -> Self {
        Self { camera: Some(camera.to_owned()), ..self }
    }

    /// The same, about a view.
    #[must_use]
    pub fn at(self, view: u64) -> Self {
        Self { view: Some(view), ..self }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}\n  rule: {}\n  remedy: {}", self.what, self.rule, self.remedy)
    }
}

impl std::error::Error for Fault {}
