//! A temporary folder of a test.

use std::path::{Path, PathBuf};

use relief_formats::body::Body;

use crate::sample_file::Sample;

/// A temporary folder with files in it; gone when dropped.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// An empty folder.
    #[allow(clippy::new_without_default, reason = "it makes a folder on the disk")]
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// The folder itself.
    pub fn dir(&self) -> &Path {
        self.0.path()
    }

    /// Where a file of this name lies.
    pub fn path(&self, name: &str) -> PathBuf {
        self.dir().join(name)
    }

    /// Writes a sample file: its path.
    pub fn sample(&self, name: &str, sample: &Sample) -> PathBuf {
        let path = self.path(name);
        sample.write(&path);
        path
    }

    /// Writes the Earth with waves, 2^(m+1) x 2^m cells: its path.
    pub fn globe(&self, name: &str, m: u32) -> PathBuf {
        self.sample(name, &Sample::new(Body::earth(), m))
    }

    /// All names in the folder, hidden ones included, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.dir()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}
