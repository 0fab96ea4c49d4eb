//! The built program, run on small files.

pub mod oracle;
pub mod rasters;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

pub use relief_formats::body::Body;
pub use relief_tests::folder::Folder;
pub use relief_tests::program::Run;
pub use relief_tests::sample_file::{Sample, wavy_q};
pub use serde_json::Value;

/// A file of the test data.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

/// Runs the program with arguments of any kind.
macro_rules! relief_bake {
    ($($argument:expr),* $(,)?) => {
        $crate::common::run(&[$(std::ffi::OsStr::new(&$argument)),*], None)
    };
}

/// The program.
pub fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_relief-bake"))
}

/// Runs the program, with text on standard input where there is some.
pub fn run(arguments: &[&OsStr], stdin: Option<&str>) -> Run {
    Run::of(program().args(arguments), stdin.unwrap_or_default())
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
