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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(body: Body) -> Metadata {
        Metadata {
            body,
            vertical: "ellipsoid".into(),
            sources: vec![serde_json::json!({"name": "a.tif"})],
            resampling: "auto".into(),
            fill: "none".into(),
            bound_m: 0.5,
            versions: BTreeMap::new(),
        }
    }

    proptest! {
        /// The header holds the same f64: text must bring back every bit.
        #[test]
        fn numbers_come_back_to_the_bit(x0 in -1e8..1e8f64, y0: f64, dx in 1e-9..1e5f64) {
            prop_assume!(y0.is_finite());
            let metadata = of(Body::Plane { crs_wkt: "x".into(), x0, y0, dx, dy: dx / 3.0 });
            let bytes = metadata.encode().unwrap();
            prop_assert_eq!(Metadata::decode(&bytes).unwrap(), metadata);
        }
    }

    #[test]
    fn keys_are_sorted_and_unknown_ones_are_allowed() {
        let text = String::from_utf8(of(Body::earth()).encode().unwrap()).unwrap();
        assert!(text.starts_with(r#"{"body":{"a_m":6378137.0,"b_m":6356752.314245179,"kind":"ellipsoid","name":"earth"},"bound_m":0.5,"fill":"none""#));
        assert!(text.ends_with("}\n") && !text.contains(": "));
        let later = text.replacen('{', r#"{"imagery":{"layers":1},"#, 1);
        assert_eq!(Metadata::decode(later.as_bytes()).unwrap(), of(Body::earth()));
        assert!(Metadata::decode(b"{}").is_err());
    }
}
