//! A folder beside an output for libraries that want a path to write to; what they wrote is then
//! renamed into place. On an error and on Ctrl-C the folder goes away with all that is in it.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once, PoisonError};

use relief_formats::file::temporary;
use tempfile::TempDir;

use crate::error::ToolError;
use crate::publish::{failed, folder_of, prefix, sync};
use crate::stderr::say;

/// A temporary folder in the folder of an output.
pub struct Staging {
    output: PathBuf,
    folder: TempDir,
    _held: Option<File>,
}

/// Folders that Ctrl-C must remove.
static LIVE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
static HANDLER: Once = Once::new();

impl Staging {
    /// Makes the folder.
    ///
    /// # Errors
    /// [`ToolError::Usage`] when `output` exists and is not to be replaced, or is a folder;
    /// [`ToolError::Io`] when its folder is missing or cannot be written.
    pub fn beside(output: &Path, replace: bool) -> Result<Self, ToolError> {
        if output.is_dir() {
            return Err(ToolError::usage(
                format!("{} is a folder", output.display()),
                "the output is a file",
                "name a file in it",
            ));
        }
        if output.symlink_metadata().is_ok() && !replace {
            return Err(ToolError::usage(
                format!("{} exists", output.display()),
                "an output that exists is not replaced unasked",
                "name another output, or give --force",
            ));
        }
        HANDLER.call_once(|| {
            // A second handler in one process is refused; then the first one's rule stands.
            let _ = ctrlc::set_handler(|| {
                for folder in LIVE.lock().unwrap_or_else(PoisonError::into_inner).iter() {
                    let _ = std::fs::remove_dir_all(folder);
                }
                say("interrupted; nothing was written");
                std::process::exit(2);
            });
        });
        let parent = folder_of(output);
        temporary::remove_stale(output);
        let made = tempfile::Builder::new().prefix(&prefix(output)).suffix(temporary::SUFFIX).tempdir_in(parent);
        let folder = made.map_err(|error| failed("cannot create a folder in", parent, error))?;
        let held = File::open(folder.path()).inspect(temporary::hold).ok();
        LIVE.lock().unwrap_or_else(PoisonError::into_inner).push(folder.path().to_path_buf());
        Ok(Self { output: output.to_path_buf(), folder, _held: held })
    }

    /// A path in the folder.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Syncs the file `name` of the folder and renames it to the output; returns its size in
    /// bytes.
    ///
    /// # Errors
    /// What the system answered.
    pub fn publish(self, name: &str) -> Result<u64, ToolError> {
        let path = self.path(name);
        let synced = File::open(&path).and_then(|file| file.sync_all().and_then(|()| file.metadata()));
        let bytes = synced.map_err(|error| failed("cannot write", &self.output, error))?.len();
        std::fs::rename(&path, &self.output).map_err(|error| failed("cannot rename to", &self.output, error))?;
        sync(folder_of(&self.output))?;
        Ok(bytes)
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let mut live = LIVE.lock().unwrap_or_else(PoisonError::into_inner);
        live.retain(|folder| folder != self.folder.path());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_published_is_all_that_stays() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("a.bin");
        let names = || std::fs::read_dir(folder.path()).unwrap().count();
        let staging = Staging::beside(&output, false).unwrap();
        std::fs::write(staging.path("x"), b"whole").unwrap();
        std::fs::write(staging.path("scratch"), b"more").unwrap();
        assert_eq!(staging.publish("x").unwrap(), 5);
        assert_eq!((std::fs::read(&output).unwrap(), names()), (b"whole".to_vec(), 1));
        assert!(Staging::beside(&output, false).is_err());
        let given_up = Staging::beside(&output, true).unwrap();
        std::fs::write(given_up.path("x"), b"half").unwrap();
        drop(given_up);
        assert_eq!((std::fs::read(&output).unwrap(), names()), (b"whole".to_vec(), 1));
    }

    #[test]
    fn folders_are_named_when_they_are_missing() {
        let folder = tempfile::tempdir().unwrap();
        let missing = Staging::beside(&folder.path().join("none/a"), false).err().unwrap().to_string();
        assert!(missing.contains("none") && missing.contains("create the folder"), "{missing}");
        assert!(Staging::beside(folder.path(), true).is_err());
        let staging = Staging::beside(&folder.path().join("a"), false).unwrap();
        assert!(staging.publish("never written").is_err());
    }
}
