//! The output's path: what it must be, the work file beside it, and errors of the disk.

use std::path::{Path, PathBuf};

use relief_front::error::ToolError;

/// The work file beside an output.
pub(super) fn work_file(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_os_string();
    name.push(".part");
    PathBuf::from(name)
}

/// Refuses an output that cannot be written, before any work is done.
pub(super) fn check_output(output: &Path, force: bool) -> Result<(), ToolError> {
    let folder = output.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if output.file_name().is_none() || output.is_dir() {
        return Err(ToolError::usage(
            format!("-o {}", output.display()),
            "the output is a file",
            "name a file, such as earth.relief",
        ));
    }
    if !folder.is_dir() {
        return Err(ToolError::usage(
            format!("-o {}: the folder {} is missing", output.display(), folder.display()),
            "the output's folder exists",
            format!("mkdir -p {}", folder.display()),
        ));
    }
    if output.exists() && !force {
        return Err(ToolError::usage(
            format!("-o {}: the file exists", output.display()),
            "nothing is replaced unasked",
            "give --force to replace it, or another name",
        ));
    }
    Ok(())
}

/// An error of the system, with what helps against its kind.
pub(super) fn io_error(action: &'static str, path: &Path, error: std::io::Error) -> ToolError {
    let remedy = match error.kind() {
        std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded | std::io::ErrorKind::FileTooLarge => {
            "free some space, or write to another disk"
        }
        std::io::ErrorKind::PermissionDenied | std::io::ErrorKind::ReadOnlyFilesystem => {
            "write to a folder that you may write to"
        }
        _ => "check the path and the disk",
    };
    ToolError::Io { action, path: path.to_path_buf(), error, remedy: remedy.into() }
}
