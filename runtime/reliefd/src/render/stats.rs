//! What a frame cost, as JSON.

use std::time::Duration;

use relief_runtime::frame::Frame;
use serde_json::{Map, Value, json};

use super::Args;
use crate::backend::Backend;

/// One line: counts, and milliseconds from the start of the program to the open file and to the
/// complete frame.
pub fn json(args: &Args, backend: &Backend, frame: &Frame, [opened, complete]: [Duration; 2]) -> String {
    let stats = &frame.stats;
    let mut passes: Map<String, Value> = Map::new();
    for &(name, ms) in &stats.pass_ms {
        passes.insert(name.to_owned(), json!(rounded(ms)));
    }
    let milliseconds = |time: Duration| rounded(time.as_secs_f64() * 1e3);
    let fetches = (stats.fetches.heights + stats.fetches.extremes) as f64;
    let fetches_per_ray = (stats.fetches.rays > 0).then(|| rounded(fetches / stats.fetches.rays as f64));
    let object = json!({
        "backend": backend.name(),
        "width": frame.width,
        "height": frame.height,
        "scheme": args.view.scheme.name(),
        "pixel_error": args.view.pixel_error,
        "triangles": stats.triangles,
        "fillers": stats.fillers,
        "passes": stats.passes,
        "tested": stats.tested,
        "culled": stats.culled,
        "holes": stats.overflow,
        "tiles_resident": stats.tiles_resident,
        "tiles_missing": stats.tiles_missing,
        "rays": stats.fetches.rays,
        "fetches_per_ray": fetches_per_ray,
        "pass_ms": passes,
        "open_ms": milliseconds(opened),
        "complete_ms": milliseconds(complete),
    });
    format!("{object}\n")
}

/// To a thousandth.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
