//! The built program, and files for it.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use serde_json::Value;

use crate::sample_file::Sample;

/// Side of a cell of [`plane`], metres.
pub const SPACING_M: f64 = 30.0;

/// A temporary folder with files in it.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn sample(&self, name: &str, sample: &Sample) -> PathBuf {
        let path = self.path(name);
        sample.write(&path);
        path
    }

    /// All names in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let names = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// A plane of 256 x 256 cells from (1000, 2000), steps of 2^-4 m.
pub fn plane(q: fn(Grid, u32, u32) -> i32) -> Sample {
    let body = Body::Plane { crs_wkt: String::new(), x0: 1000.0, y0: 2000.0, dx: SPACING_M, dy: SPACING_M };
    Sample { q, ..Sample::new(body, 8) }
}

/// How a run of the program ended.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// Standard output as JSON, after a run that ended with `code`.
    pub fn json(&self, code: i32) -> Value {
        assert_eq!(self.code, code, "{}", self.stderr);
        serde_json::from_str(&self.stdout).unwrap()
    }

    pub fn good(self) -> Self {
        assert_eq!(self.code, 0, "{}{}", self.stdout, self.stderr);
        self
    }
}

/// Runs the program in words, `FILE` standing for a path.
pub fn reliefd(words: &str, file: &Path) -> Run {
    with_input(words, file, "")
}

/// The same with text on standard input.
pub fn with_input(words: &str, file: &Path, text: &str) -> Run {
    let arguments = words.split_whitespace().map(|word| match word {
        "FILE" => file.display().to_string(),
        // Outputs lie beside the file.
        word => match word.strip_prefix("OUT/") {
            Some(name) => file.with_file_name(name).display().to_string(),
            None => word.to_owned(),
        },
    });
    let mut child = Command::new(env!("CARGO_BIN_EXE_reliefd"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let text = text.to_owned();
    let mut input = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output().unwrap();
    // A program that refuses its arguments need not read.
    let _ = writer.join().unwrap();
    let words = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code().unwrap(), stdout: words(output.stdout), stderr: words(output.stderr) }
}

/// An 8-bit PNG: width, height, channels, samples.
pub fn png(path: &Path) -> (u32, u32, usize, Vec<u8>) {
    let bytes = std::fs::read(path).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut samples).unwrap();
    (info.width, info.height, info.color_type.samples(), samples)
}
