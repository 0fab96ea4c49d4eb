//! Output files appear whole or not at all: temporary file, sync, rename, sync of the folder.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use crate::error::ToolError;

/// Writes a file beside its final place and renames it there; an existing file is replaced.
///
/// # Errors
/// What the system or `write` answered. Then nothing is left behind, and a file that was there
/// before is untouched.
pub fn publish(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> Result<(), ToolError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let failed = |action: &'static str, path: &Path, error: io::Error| {
        let remedy = match error.kind() {
            io::ErrorKind::NotFound => "create the folder, or name another".into(),
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder that can be written".into()
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                "free some space, or choose another disk".into()
            }
            _ => "choose another output path".into(),
        };
        ToolError::Io { action, path: PathBuf::from(path), error, remedy }
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".relief-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666)); // less the umask, as for any file
    }
    let temporary = builder.tempfile_in(folder).map_err(|error| failed("cannot create a file in", folder, error))?;
    let mut buffer = BufWriter::new(temporary.as_file());
    let written = write(&mut buffer).and_then(|()| buffer.flush());
    drop(buffer);
    written.and_then(|()| temporary.as_file().sync_all()).map_err(|error| failed("cannot write", path, error))?;
    temporary.persist(path).map_err(|error| failed("cannot rename to", path, error.error))?;
    File::open(folder).and_then(|folder| folder.sync_all()).map_err(|error| failed("cannot sync", folder, error))
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

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = publish(&folder.path().join("none/a.bin"), |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("none"), "{error}");
    }
}
