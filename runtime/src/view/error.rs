//! Views that cannot be drawn: the caller corrects them.

use relief_formats::geodesy::AngleError;

/// A view that shows nothing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ViewError {
    /// A longitude or latitude that names no place.
    #[error(transparent)]
    Angle(#[from] AngleError),
    /// A number outside its range, or not a number.
    #[error("{what} of {value}: must be {rule}")]
    Number {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
    /// A picture without pixels, or with more than the adapter can hold.
    #[error("picture of {width} x {height} pixels: each side must be {}", limit.map_or("at least 1".into(), |limit| format!("1 to {limit} here")))]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// Largest side, where that is what stands in the way.
        limit: Option<u32>,
    },
    /// A kernel that this file or this backend does not have.
    #[error("{what}: {rule}")]
    Kernel {
        /// What was asked for.
        what: &'static str,
        /// Where it can be had.
        rule: &'static str,
    },
    /// A place or sun of a globe was given for a plane, or the other way round.
    #[error("{what} for a {given}, but the file holds a {file}")]
    Body {
        /// What was given.
        what: &'static str,
        /// The kind of body it is for.
        given: &'static str,
        /// The kind of body of the file.
        file: &'static str,
    },
}

/// "plane" or "globe".
pub(super) fn kind(plane: bool) -> &'static str {
    if plane { "plane" } else { "globe" }
}
