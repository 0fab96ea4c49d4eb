//! The one place that maps a file into memory.

use std::fs::File;
use std::path::Path;

use memmap2::Mmap;

use super::FormatError;

/// Maps a file read-only.
#[allow(unsafe_code, reason = "a memory map is unsafe by nature")]
pub fn map(path: &Path) -> Result<Mmap, FormatError> {
    let io = |action: &'static str| move |error| FormatError::Io { action, path: path.to_path_buf(), error };
    let file = File::open(path).map_err(io("cannot open"))?;
    let length = file.metadata().map_err(io("cannot read the size of"))?.len();
    if length == 0 {
        return Err(FormatError::NotRelief("the file is empty"));
    }
    // SAFETY: files are published whole by rename and never edited in place (SPEC, "Publishing"),
    // so the bytes do not change under the map.
    unsafe { Mmap::map(&file) }.map_err(io("cannot map"))
}
