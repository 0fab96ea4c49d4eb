//! Speed against error of a planet: meshes by scheme and threshold, shadows by kernel and level.
//!
//! Every error is measured in f64 against S_0 itself, by code that the kernels do not share.

mod cameras;
mod csv;
mod figures;
mod mesh_error;
mod meshes;
mod page;
mod shadows;

use std::path::Path;
use std::sync::Arc;

use relief_front::error::ToolError;
use relief_front::sheet::folder::Folder;
use relief_front::sheet::machine::Machine;

use crate::frame::RenderError;
use crate::planet::Planet;

pub use cameras::{Shot, shots};
pub use mesh_error::{MeshError, measure};
pub use meshes::MeshRow;
pub use shadows::{PAPER, ShadowRow};

/// What a report is made with.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Size of the pictures whose meshes are measured.
    pub size: [u32; 2],
    /// Thresholds, pixels.
    pub thresholds_px: Vec<f32>,
    /// Points of S_0 measured in each view.
    pub points: usize,
    /// Rays cast for each sun and kernel.
    pub rays: usize,
    /// Rays of them checked against the oracle.
    pub checked: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            size: [1920, 1080],
            thresholds_px: vec![0.5, 1.0, 2.0, 4.0, 8.0],
            points: 100_000,
            rays: 200_000,
            checked: 4_000,
        }
    }
}

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Report {
    /// The file's name.
    pub file: String,
    /// What it holds, in a sentence.
    pub about: String,
    /// Where and when.
    pub machine: Machine,
    /// Picture size, pixels.
    pub size: [u32; 2],
    /// Meshes.
    pub meshes: Vec<MeshRow>,
    /// Shadows.
    pub shadows: Vec<ShadowRow>,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A view or the file.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The folder.
    #[error(transparent)]
    Output(#[from] ToolError),
}

/// Measures a planet. `progress` is told what is being measured, and what share is done.
///
/// # Errors
/// [`ReportError::Render`]: a damaged tile.
pub fn run(
    planet: &Arc<Planet>,
    file: &str,
    options: &Options,
    progress: &dyn Fn(&str, f64),
) -> Result<Report, ReportError> {
    let machine = Machine::here();
    let header = planet.relief().header();
    let grid = planet.grid();
    let about = format!(
        "{} × {} nodes (m = {}), step {} m, heights {} to {} m",
        grid.width(0),
        grid.height(0),
        grid.m,
        header.step_m(),
        f64::from(header.min_q) * header.step_m(),
        f64::from(header.max_q) * header.step_m(),
    );
    let meshes = meshes::run(planet, options, &|what, share| progress(what, 0.6 * share))?;
    let shadows = shadows::run(planet, options, &|what, share| progress(what, 0.6 + 0.4 * share))?;
    Ok(Report { file: file.to_owned(), about, machine, size: options.size, meshes, shadows })
}

/// Writes the page, its plots and tables into a folder, all or nothing.
///
/// # Errors
/// [`ReportError::Output`]: the folder has content and `force` is not given, or the disk.
pub fn write(report: &Report, path: &Path, force: bool) -> Result<(), ReportError> {
    let folder = Folder::open(path, force)?;
    let figures = figures::all(report);
    let mut files = vec![
        ("index.html", page::html(report, &figures)),
        ("meshes.csv", csv::meshes(&report.meshes)),
        ("shadows.csv", csv::shadows(&report.shadows)),
    ];
    files.extend(figures.iter().map(|figure| (figure.file, figure.svg.standalone())));
    let stale: Vec<&str> = figures::NAMES.into_iter().filter(|n| files.iter().all(|(name, _)| name != n)).collect();
    Ok(folder.publish(&files, &stale)?)
}

#[cfg(test)]
mod tests;
