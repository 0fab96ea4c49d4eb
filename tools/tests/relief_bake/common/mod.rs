//! The built program, run on small files.

pub mod oracle;
pub mod rasters;
#[path = "../../../../tests/support/sample_file.rs"]
pub mod sample_file;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

pub use relief_formats::body::Body;
pub use sample_file::{Sample, wavy_q};
pub use serde_json::Value;

/// A file of the test data.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

/// A temporary folder with files in it.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a sample file.
    pub fn sample(&self, name: &str, sample: &Sample) -> PathBuf {
        let path = self.path(name);
        sample.write(&path);
        path
    }

    /// All names in the folder, hidden ones included, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<_> = std::fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

/// How a run of the program ended.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    fn of(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Standard output as JSON, after a run that ended with `code`.
    pub fn json(&self, code: i32) -> Value {
        assert_eq!(self.code, code, "{}", self.stderr);
        serde_json::from_str(&self.stdout).unwrap()
    }

    /// A message with all its parts, on exit code 2 and nothing on standard output.
    pub fn refused(&self, words: &[&str]) {
        assert_eq!(self.code, 2, "{}{}", self.stdout, self.stderr);
        assert!(self.stdout.is_empty(), "{}", self.stdout);
        for word in words.iter().chain(&["remedy:"]) {
            assert!(self.stderr.contains(word), "{word:?} is not in: {}", self.stderr);
        }
    }
}

/// Runs the program with arguments of any kind.
macro_rules! relief_bake {
    ($($argument:expr),* $(,)?) => {
        $crate::common::run(&[$(std::ffi::OsStr::new(&$argument)),*], None)
    };
}

/// Runs the program, with text on standard input where there is some.
pub fn run(arguments: &[&std::ffi::OsStr], stdin: Option<&str>) -> Run {
    let mut child = Command::new(env!("CARGO_BIN_EXE_relief-bake"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let text = stdin.unwrap_or_default().to_owned();
    let mut input = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output().unwrap();
    // A program that refuses its arguments need not read.
    let _ = writer.join().unwrap();
    Run::of(output)
}

/// Body of an Earth sample.
pub fn earth(m: u32) -> Sample {
    Sample::new(Body::earth(), m)
}

/// A plane with spacing 30 x 20 from (500000, 4000000) in UTM zone 11 N.
pub fn plane(m: u32) -> Sample {
    let crs_wkt = include_str!("utm11.wkt").to_owned();
    Sample::new(Body::Plane { crs_wkt, x0: 500_000.0, y0: 4_000_000.0, dx: 30.0, dy: 20.0 }, m)
}
