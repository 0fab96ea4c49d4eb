//! The codec of a tile's planes: prediction, contexts and entropy coding (SPEC, "Planes").
//!
//! A plane is predicted from what its reader already has, the integer residuals are mapped to
//! tokens under a context, and the tokens go through an interleaved rANS coder with fixed tables.

pub mod bits;
pub mod bytes;
pub mod constraint;
mod crown;
pub mod deviation;
pub mod filled;
pub mod hext;
pub mod lifting;
pub mod mip;
pub mod nodes;
pub mod rans;
pub mod residual;
mod rows;
mod samples;
mod scratch;
pub mod tables;
pub mod token;

/// Why a plane's bytes cannot be decoded. The file is damaged or was not written by this format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodecError {
    /// The bytes end before the samples do.
    #[error("the plane ends early")]
    Truncated,
    /// The bytes go on after the last sample, or the coder does not end in its start state.
    #[error("the plane does not end where its last sample does")]
    Trailing,
    /// A number is outside what the format allows.
    #[error("a number in the plane is out of range")]
    Range,
    /// The general-purpose compressor refused the frame.
    #[error("the compressed frame is damaged")]
    Frame,
    /// The samples decode, but are not those that were written.
    #[error("the samples do not match their checksum")]
    Digest,
}

/// Version of the zstd library that is built in: 10000 major + 100 minor + patch.
#[must_use]
pub fn zstd_version_number() -> u32 {
    zstd::zstd_safe::version_number()
}
