//! Where files cannot be guarded: one that is cut while it is mapped ends the daemon, if the system lets
//! it be cut at all.

use std::path::Path;

use relief_formats::file::{FormatError, Relief};

/// Maps a file.
///
/// # Errors
/// Those of [`Relief::open`].
pub fn open(path: &Path) -> Result<Relief, FormatError> {
    Relief::open(path)
}

/// None are seen.
pub fn faults(_: &[u8]) -> u64 {
    0
}
