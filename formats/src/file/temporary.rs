//! Temporaries beside an output: what they are called, and which of them a killed process left.
//!
//! A temporary of NAME is `.NAME.PID.tmp` or `.NAME.PID.MORE.tmp`, a file or a folder, and whoever
//! fills it holds its lock until it has become NAME. A process that is killed leaves it behind; the
//! next one that writes NAME removes it if nobody holds the lock, and besides PID is no process of
//! this system or nothing has changed for a day (numbers of processes come again). The number alone
//! would not do: a folder may be shared with other hosts and containers, whose processes do not show
//! here; a lock is the kernel's, and on network file systems the server's. Where a file system has
//! no locks, what was left stays.

use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What a temporary's name ends with.
pub const SUFFIX: &str = ".tmp";

/// After so long without a change a temporary is not one of the process that has its number now.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// Longest NAME, bytes, that goes into a temporary's name: file systems allow 255 in all.
const LONGEST_NAME: usize = 200;

/// `.NAME.`, with which every temporary of an output begins.
fn prefix(output: &Path) -> OsString {
    let name = output.file_name().filter(|name| name.len() <= LONGEST_NAME).unwrap_or(OsStr::new("relief-output"));
    let mut prefix = OsString::from(".");
    prefix.push(name);
    prefix.push(".");
    prefix
}

/// `.NAME.PID`, with which this process's temporaries of an output begin; [`SUFFIX`] ends them.
#[must_use]
pub fn stem(output: &Path) -> OsString {
    let mut stem = prefix(output);
    stem.push(std::process::id().to_string());
    stem
}

/// Holds a temporary until the handle is closed, so that no other process takes it for left behind.
pub fn hold(temporary: &File) {
    // Where there are no locks nothing is removed either.
    let _ = temporary.try_lock();
}

/// Removes temporaries of an output that killed processes left; what cannot be removed stays.
pub fn remove_stale(output: &Path) {
    let folder = output.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let prefix = prefix(output);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let left = entries.filter(|entry| {
        writer(&entry.file_name(), &prefix).is_some_and(|pid| is_stale(&entry.path(), pid) == Some(true))
    });
    let left: Vec<PathBuf> = left.map(|entry| entry.path()).collect();
    for path in left {
        // Another process may be quicker, and what stays is in nobody's way.
        let _ = if path.is_dir() { std::fs::remove_dir_all(&path) } else { std::fs::remove_file(&path) };
    }
}

/// The process that a temporary's name holds.
fn writer(name: &OsStr, prefix: &OsStr) -> Option<u32> {
    let rest = name.as_encoded_bytes().strip_prefix(prefix.as_encoded_bytes())?;
    let rest = str::from_utf8(rest.strip_suffix(SUFFIX.as_bytes())?).ok()?;
    let (pid, more) = rest.split_once('.').unwrap_or((rest, ""));
    let plain = |text: &str| text.bytes().all(|byte| byte.is_ascii_alphanumeric());
    if pid.starts_with(|first: char| first.is_ascii_digit()) && plain(more) { pid.parse().ok() } else { None }
}

/// None where that cannot be told.
fn is_stale(path: &Path, pid: u32) -> Option<bool> {
    let metadata = path.symlink_metadata().ok()?;
    // Not a link or a pipe: those are not ours.
    let file = match (metadata.is_file(), metadata.is_dir()) {
        (true, _) => File::options().write(true).open(path).ok()?,
        (_, true) => File::open(path).ok()?,
        _ => return None,
    };
    let gone = is_running(pid) == Some(false) || metadata.modified().ok()?.elapsed().ok()? > DAY;
    Some(gone && file.try_lock().is_ok())
}

/// Whether this system has a process of that number; none where that cannot be told.
fn is_running(pid: u32) -> Option<bool> {
    let processes = Path::new("/proc");
    // Without a /proc of Linux no number is there, not even our own.
    processes.join(std::process::id().to_string()).exists().then(|| processes.join(pid.to_string()).exists())
}

#[cfg(test)]
mod tests;
