//! Standard error. Where nobody reads it the exit code says enough: work goes on.

use std::io::{self, Write as _};

/// Writes a line to standard error, as well as that can be done.
pub fn say(line: &str) {
    let _ = io::stderr().lock().write_all(format!("{line}\n").as_bytes());
}
