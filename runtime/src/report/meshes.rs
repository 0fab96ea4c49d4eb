//! Meshes of each view by each scheme at each threshold: triangles, time, measured error.

use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_formats::surface::Surface;

use super::cameras::{Shot, shots};
use super::mesh_error::{MeshError, measure};
use super::{Options, ReportError};
use crate::cpu::Cpu;
use crate::frame::{RenderError, Renderer as _, Scheme};
use crate::planet::Planet;
use crate::view::{Sun, View};

/// Tiles kept in RAM while a view is measured.
const ATLAS_BYTES: u64 = 1 << 30;
/// The uniform mesh has at most this many triangles.
const UNIFORM_TRIANGLES: u64 = 4 << 20;
/// A mesh is built this often; the median counts.
const RUNS: usize = 5;

/// One mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshRow {
    /// The view.
    pub view: &'static str,
    /// `leb`, `paper`, or `uniform`.
    pub scheme: &'static str,
    /// Threshold, pixels; none for the uniform mesh.
    pub threshold_px: Option<f32>,
    /// Triangles.
    pub triangles: usize,
    /// Milliseconds on the CPU backend, all cores.
    pub cpu_ms: f64,
    /// Against S_0.
    pub error: MeshError,
}

pub(super) fn run(
    planet: &Arc<Planet>,
    options: &Options,
    progress: &dyn Fn(&str, f64),
) -> Result<Vec<MeshRow>, ReportError> {
    let shots = shots(planet).map_err(RenderError::from)?;
    let surface = Surface::new(planet.relief(), 256 << 20);
    let uniform = Scheme::Uniform { level: uniform_level(planet) };
    let mut cases: Vec<(&str, Scheme, Option<f32>)> = Vec::new();
    for (name, scheme) in [("leb", Scheme::Leb), ("paper", Scheme::Paper)] {
        cases.extend(options.thresholds_px.iter().map(|&px| (name, scheme, Some(px))));
    }
    cases.push(("uniform", uniform, None));
    let mut rows = Vec::new();
    for (n, shot) in shots.iter().enumerate() {
        progress(shot.name, n as f64 / shots.len() as f64);
        let mut cpu = Cpu::new(Arc::clone(planet), ATLAS_BYTES)?;
        for &(name, scheme, threshold_px) in &cases {
            rows.push(row(planet, &surface, &mut cpu, shot, options, (name, scheme, threshold_px))?);
        }
    }
    Ok(rows)
}

fn row(
    planet: &Arc<Planet>,
    surface: &Surface<'_>,
    cpu: &mut Cpu,
    shot: &Shot,
    options: &Options,
    (name, scheme, threshold_px): (&'static str, Scheme, Option<f32>),
) -> Result<MeshRow, ReportError> {
    let sun = if planet.grid().plane { Sun::at(0.0, 45.0) } else { Sun::over(0.0, 0.0) };
    let mut view = View::new(shot.camera, options.size, sun.map_err(RenderError::from)?);
    view.pixel_error = threshold_px.unwrap_or(view.pixel_error);
    let mut triangles = cpu.mesh(&view, scheme)?;
    while cpu.update(Duration::from_secs(60)).loaded > 0 {
        triangles = cpu.mesh(&view, scheme)?;
    }
    let mut times_ms = Vec::new();
    for _ in 0..RUNS {
        let begin = Instant::now();
        triangles = cpu.mesh(&view, scheme)?;
        times_ms.push(begin.elapsed().as_secs_f64() * 1e3);
    }
    times_ms.sort_by(f64::total_cmp);
    let error = measure(planet, surface, &view, &triangles, options.points).map_err(RenderError::from)?;
    Ok(MeshRow {
        view: shot.name,
        scheme: name,
        threshold_px,
        triangles: triangles.len(),
        cpu_ms: times_ms[RUNS / 2],
        error,
    })
}

/// The finest level whose whole mesh is small enough to be drawn.
fn uniform_level(planet: &Planet) -> u32 {
    let grid = planet.grid();
    let triangles = |level: u32| 2 * u64::from(grid.width(level)) * u64::from(grid.height(level));
    (0..grid.root_level()).find(|&level| triangles(level) <= UNIFORM_TRIANGLES).unwrap_or(grid.root_level())
}
