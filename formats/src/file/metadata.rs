//! Where a file's heights come from: canonical JSON, without clock or host (SPEC, "Metadata").

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::FormatError;
use crate::body::Body;

/// The metadata section. Unknown keys are kept out of the typed view but allowed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// The body with its name, or the plane with its CRS.
    pub body: Body,
    /// What heights are measured from: `ellipsoid`, `egm96 added`, `as given` ...
    pub vertical: String,
    /// How each source became heights, in the order given.
    pub sources: Vec<serde_json::Value>,
    /// The kernel asked for.
    pub resampling: String,
    /// What nodes without data hold.
    pub fill: String,
    /// Largest quantisation error, metres: half a step.
    pub bound_m: f64,
    /// Program and library versions that can change bytes.
    pub versions: BTreeMap<String, String>,
}

impl Metadata {
    /// Largest size a reader accepts.
    pub const MAX_BYTES: u64 = 16 << 20;

    /// Canonical form: keys sorted, no spaces, one newline at the end.
    pub fn encode(&self) -> Result<Vec<u8>, FormatError> {
        let value = serde_json::to_value(self).map_err(|e| FormatError::Request(format!("metadata: {e}")))?;
        Ok(format!("{value}\n").into_bytes())
    }

    /// Reads the section.
    pub fn decode(bytes: &[u8]) -> Result<Self, FormatError> {
        serde_json::from_slice(bytes).map_err(|e| FormatError::damaged(format!("metadata: {e}")))
    }
}
