//! The one place that maps a file into memory.

use std::fs::File;
use std::path::Path;

use memmap2::{Mmap, MmapMut};

use super::FormatError;

/// Maps a file read-only; the file stays open, so that its size can be asked for.
#[allow(unsafe_code, reason = "a memory map is unsafe by nature")]
pub fn map(path: &Path) -> Result<(Mmap, File), FormatError> {
    let io = |action: &'static str| move |error| FormatError::Io { action, path: path.to_path_buf(), error };
    let file = File::open(path).map_err(io("cannot open"))?;
    let length = file.metadata().map_err(io("cannot read the size of"))?.len();
    if length == 0 {
        return Err(FormatError::NotRelief("the file is empty"));
    }
    // SAFETY: files are published whole by rename and never edited in place (SPEC, "Publishing"),
    // so the bytes do not change under the map.
    let map = unsafe { Mmap::map(&file) }.map_err(io("cannot map"))?;
    Ok((map, file))
}

/// A private copy of bytes that came from elsewhere.
pub fn copy(bytes: &[u8]) -> Result<Mmap, FormatError> {
    if bytes.is_empty() {
        return Err(FormatError::NotRelief("the file is empty"));
    }
    let io = |error| FormatError::Io { action: "cannot reserve memory", path: "(memory)".into(), error };
    let mut map = MmapMut::map_anon(bytes.len()).map_err(io)?;
    map.copy_from_slice(bytes);
    map.make_read_only().map_err(io)
}
