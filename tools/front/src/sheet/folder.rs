//! The folder of a report: made if it is missing, unmade if the report fails.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use relief_formats::file::temporary;
use tempfile::TempDir;

use crate::error::ToolError;
use crate::publish::{self, publish};

/// An output folder with a scratch folder in it, which goes whatever happens.
pub struct Folder {
    path: PathBuf,
    made: bool,
    scratch: Option<TempDir>,
    held: Option<File>,
}

impl Folder {
    /// Opens or makes the folder. With `force` it may have content.
    ///
    /// # Errors
    /// [`ToolError::Usage`] for a folder with content or a file, [`ToolError::Io`] where the
    /// system says no.
    pub fn open(path: &Path, force: bool) -> Result<Self, ToolError> {
        let shown = path.display();
        let scratch_name = path.join("scratch");
        temporary::remove_stale(&scratch_name);
        let made = match std::fs::read_dir(path).map(|mut content| content.next().is_some()) {
            Ok(true) if !force => {
                return Err(ToolError::usage(
                    format!("-o {shown}: the folder is not empty"),
                    "nothing is replaced unasked",
                    "add --force to replace a report that is there, or name another folder",
                ));
            }
            Ok(_) => false,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                std::fs::create_dir(path).map_err(|error| failed("cannot create the folder", path, error))?;
                true
            }
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
                return Err(ToolError::usage(
                    format!("-o {shown}: it is a file"),
                    "a report is a folder with a page, tables and plots",
                    "name a folder, new or empty",
                ));
            }
            Err(error) => return Err(failed("cannot read the folder", path, error)),
        };
        let mut folder = Self { path: path.to_path_buf(), made, scratch: None, held: None };
        let prefix = publish::prefix(&scratch_name);
        let scratch = tempfile::Builder::new().prefix(&prefix).suffix(temporary::SUFFIX).tempdir_in(path);
        let scratch = scratch.map_err(|error| failed("cannot create a folder in", path, error))?;
        folder.held = File::open(scratch.path()).inspect(temporary::hold).ok();
        folder.scratch = Some(scratch);
        Ok(folder)
    }

    /// A path for a file that goes with this value.
    #[must_use]
    pub fn scratch(&self, name: &str) -> PathBuf {
        self.scratch.as_ref().map_or(self.path.as_path(), TempDir::path).join(name)
    }

    /// Publishes the files of a finished report; those named in `stale` are an older one's and go.
    ///
    /// # Errors
    /// What the system answered.
    pub fn publish(mut self, files: &[(&str, String)], stale: &[&str]) -> Result<(), ToolError> {
        self.held = None;
        if let Some(scratch) = self.scratch.take() {
            scratch.close().map_err(|error| failed("cannot remove a folder in", &self.path, error))?;
        }
        for (done, (name, text)) in files.iter().enumerate() {
            if let Err(error) = publish(&self.path.join(name), |out| out.write_all(text.as_bytes())) {
                if self.made {
                    for (name, _) in &files[..done] {
                        // The first error is the one to report.
                        let _ = std::fs::remove_file(self.path.join(name));
                    }
                }
                return Err(error);
            }
        }
        self.made = false;
        for path in stale.iter().map(|name| self.path.join(name)) {
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(failed("cannot remove", &path, error));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        drop(self.scratch.take());
        if self.made {
            // It is empty unless someone else has put something there, which then stays.
            let _ = std::fs::remove_dir(&self.path);
        }
    }
}

fn failed(action: &'static str, path: &Path, error: io::Error) -> ToolError {
    match error.kind() {
        io::ErrorKind::NotFound => {
            let remedy = "create the folder it is to lie in, or name another".into();
            ToolError::Io { action, path: path.to_path_buf(), error, remedy }
        }
        _ => publish::failed(action, path, error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_report_leaves_nothing() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("report");
        let folder = Folder::open(&path, false).unwrap();
        std::fs::write(folder.scratch("a.relief"), "bytes").unwrap();
        drop(folder);
        assert!(!path.exists());
        // A folder that was there stays, without the scratch.
        std::fs::create_dir(&path).unwrap();
        drop(Folder::open(&path, false).unwrap());
        assert_eq!(std::fs::read_dir(&path).unwrap().count(), 0);
        // Neither do files of which a later one cannot be written.
        std::fs::remove_dir(&path).unwrap();
        let files = [("a.csv", String::new()), ("none/b.svg", String::new())];
        Folder::open(&path, false).unwrap().publish(&files, &[]).unwrap_err();
        assert!(!path.exists());
    }

    #[test]
    fn what_is_there_is_replaced_only_when_asked() {
        let parent = tempfile::tempdir().unwrap();
        for name in ["report.csv", "old.svg"] {
            std::fs::write(parent.path().join(name), "old").unwrap();
        }
        assert!(matches!(Folder::open(parent.path(), false), Err(ToolError::Usage { .. })));
        Folder::open(parent.path(), true)
            .unwrap()
            .publish(&[("report.csv", "new".into())], &["old.svg", "never.svg"])
            .unwrap();
        assert_eq!(std::fs::read_to_string(parent.path().join("report.csv")).unwrap(), "new");
        assert!(!parent.path().join("old.svg").exists());
        assert!(matches!(Folder::open(&parent.path().join("report.csv"), true), Err(ToolError::Usage { .. })));
        assert!(matches!(Folder::open(&parent.path().join("no/where"), true), Err(ToolError::Io { .. })));
    }
}
