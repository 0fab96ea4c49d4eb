//! The files that are served: opened, named, each with an engine.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use relief_front::error::ToolError;
use relief_runtime::planet::Planet;

use super::Args;
use super::cannot;
use super::engine::{Engine, Limits, StartError};
use super::hub::{Hub, Served};
use super::meters::Meters;
use crate::backend::Backend;
use crate::errors::{of_render, opened};
use crate::truncated;

/// Opens all files.
///
/// # Errors
/// A file that cannot be served, two of one name, a backend that is not there.
pub fn hub(args: &Args, token: Option<&str>) -> Result<Hub, ToolError> {
    check_names(&args.files)?;
    let share = args.files.len().max(1) as u64;
    let mut hub = Hub::new(args.max_viewers as usize, token, Arc::new(Meters::default()));
    for path in &args.files {
        let name = stem(path);
        let backend = Backend::find(args.backend)?;
        let ram = args.memory_limit / share;
        let (cache_bytes, atlas_bytes) = match backend {
            // The CPU's atlas lies in RAM too.
            Backend::Cpu => (ram / 2, ram / 2),
            Backend::Gpu(_) => (ram, args.gpu_memory_limit / share),
        };
        let planet = open(path, cache_bytes)?;
        let ear = hub.ear(&name, &planet);
        let limits = Limits { backend: args.backend, atlas_bytes, time_budget: args.time_budget };
        let engine = Engine::start(planet, backend, limits, ear.clone()).map_err(|error| match error {
            StartError::Render(error) => of_render(path)(error),
            StartError::Thread(error) => cannot("start its threads", &error),
        })?;
        tracing::info!(planet = name, path = %path.display(), backend = engine.backend(), "serving");
        hub.add(Served::new(&ear, path.clone(), Arc::new(engine)));
    }
    Ok(hub)
}

/// Opens a file as a planet, keeping up to `cache_bytes` of decoded samples.
///
/// # Errors
/// A file that cannot be served.
pub fn open(path: &Path, cache_bytes: u64) -> Result<Arc<Planet>, ToolError> {
    let relief = truncated::open(path).map_err(ToolError::of_file(path))?;
    Planet::new(relief, cache_bytes).map_err(opened(path))
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Refuses two files that would have one name.
fn check_names(files: &[PathBuf]) -> Result<(), ToolError> {
    for (at, path) in files.iter().enumerate() {
        let name = stem(path);
        if let Some(other) = files.iter().take(at).find(|other| stem(other) == name) {
            return Err(ToolError::usage(
                format!("{} and {} are both {name}", other.display(), path.display()),
                "a file is served under its stem, and no two have the same",
                "rename one, or serve it through a link of another name",
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;

    #[test]
    fn names_are_told_apart() {
        let check = |names: &[&str]| check_names(&names.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert!(check(&["a/earth.relief", "a/moon.relief", "earth2.relief"]).is_ok());
        let error = check(&["a/earth.relief", "moon.relief", "b/earth.relief"]).unwrap_err().to_string();
        assert!(error.contains("a/earth.relief and b/earth.relief") && error.contains("remedy:"), "{error}");
    }
}
