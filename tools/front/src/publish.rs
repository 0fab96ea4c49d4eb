//! Output files appear whole or not at all: temporary file, sync, rename, sync of the folder.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use relief_formats::file::temporary;

use crate::error::ToolError;

/// Writes a file beside its final place and renames it there; an existing file is replaced.
///
/// # Errors
/// What the system or `write` answered. Then nothing is left behind, and a file that was there
/// before is untouched.
pub fn publish(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> Result<(), ToolError> {
    let folder = folder_of(path);
    temporary::remove_stale(path);
    let prefix = prefix(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(temporary::SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666)); // less the umask, as for any file
    }
    let made = builder.tempfile_in(folder).map_err(|error| failed("cannot create a file in", folder, error))?;
    temporary::hold(made.as_file());
    let mut buffer = BufWriter::new(made.as_file());
    let written = write(&mut buffer).and_then(|()| buffer.flush());
    drop(buffer);
    written.and_then(|()| made.as_file().sync_all()).map_err(|error| failed("cannot write", path, error))?;
    made.persist(path).map_err(|error| failed("cannot rename to", path, error.error))?;
    sync(folder)
}

/// What the names of an output's temporaries begin with; something random follows.
pub(crate) fn prefix(output: &Path) -> OsString {
    let mut prefix = temporary::stem(output);
    prefix.push(".");
    prefix
}

/// The folder that an output lies in.
pub(crate) fn folder_of(output: &Path) -> &Path {
    output.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes renames in a folder last.
pub(crate) fn sync(folder: &Path) -> Result<(), ToolError> {
    let synced = File::open(folder).and_then(|folder| folder.sync_all());
    synced.map_err(|error| failed("cannot sync", folder, error))
}

/// What a user can do about an output that cannot be written.
pub(crate) fn failed(action: &'static str, path: &Path, error: io::Error) -> ToolError {
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => "create the folder, or name another",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "choose a folder that can be written",
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "free some space, or choose another disk",
        _ => "choose another output path",
    };
    ToolError::Io { action, path: path.to_path_buf(), error, remedy: remedy.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        publish(&path, |out| out.write_all(b"one")).unwrap();
        publish(&path, |out| out.write_all(b"two")).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn a_failure_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        publish(&path, |out| out.write_all(b"one")).unwrap();
        let refused = publish(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        });
        assert!(refused.unwrap_err().to_string().contains("free some space"));
        assert_eq!(std::fs::read(&path).unwrap(), b"one");
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    /// A process killed while it wrote left the first two; the last one's is at work.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_a_killed_process_left_goes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        let mut child = std::process::Command::new("true").spawn().unwrap();
        child.wait().unwrap();
        for pid in [child.id(), std::process::id()] {
            std::fs::write(folder.path().join(format!(".a.bin.{pid}.xYz12.tmp")), b"half").unwrap();
        }
        std::fs::create_dir(folder.path().join(format!(".a.bin.{}.folder.tmp", child.id()))).unwrap();
        publish(&path, |out| out.write_all(b"whole")).unwrap();
        let mut names = names(folder.path());
        names.sort();
        assert_eq!(names, [format!(".a.bin.{}.xYz12.tmp", std::process::id()), "a.bin".into()]);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = publish(&folder.path().join("none/a.bin"), |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("none"), "{error}");
    }
}
