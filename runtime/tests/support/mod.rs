//! What the tests of the GPU backend share.

use std::sync::Arc;

use relief_runtime::gpu::{AdapterChoice, Device};
use relief_runtime::planet::Planet;

use crate::sample_file::Sample;

/// The device of these tests; none where `RELIEF_NO_GPU=1` says that there is no adapter.
///
/// # Panics
/// Where there is no adapter and nobody said so.
pub fn device() -> Option<Device> {
    if std::env::var_os("RELIEF_NO_GPU").is_some_and(|v| v == "1") {
        eprintln!("RELIEF_NO_GPU=1: nothing is tested on a GPU");
        return None;
    }
    match Device::headless(AdapterChoice::Fastest) {
        Ok(device) => Some(device),
        Err(error) => panic!("{error} (RELIEF_NO_GPU=1 leaves the tests that need one out)"),
    }
}

/// A planet of a sample.
pub fn planet(sample: &Sample) -> Arc<Planet> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sample.relief");
    sample.write(&path);
    Planet::open(&path).unwrap()
}
