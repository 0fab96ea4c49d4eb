//! A report from beginning to end.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use relief_formats::grid::M_RANGE;

use super::at_samples::Samples;
use super::codecs::{Codec, compare};
use super::measure::{Bench, Case, Measured};
use super::{csv, figures, page};
use crate::bake::Plan;
use crate::progress::Progress;
use crate::source::{BodyChoice, Resample, SourceOptions, SourceRecord, SourceSet, open_sources};
use relief_front::error::ToolError;
use relief_front::sheet::folder::Folder;
use relief_front::sheet::machine::Machine;

/// Exponents of the steps that are tried.
pub const STEP_EXPONENTS: std::ops::RangeInclusive<i8> = -6..=3;
/// The kernels that are tried.
pub const KERNELS: [Resample; 5] =
    [Resample::Nearest, Resample::Bilinear, Resample::Cubic, Resample::Lanczos, Resample::Average];
/// Step where the sources have none of their own, as in a bake.
const DEFAULT_STEP_EXPONENT: i8 = -4;
/// Tiles of a file on the grid that is chosen by default: a whole globe at m = 12.
const TILE_LIMIT: usize = 700;

/// What to report on and where.
#[derive(Clone, Debug)]
pub struct ReportOptions {
    /// The folder to write.
    pub output: PathBuf,
    /// The map exponent; by default that of a bake, but less where a file would have many tiles.
    pub m: Option<u32>,
    /// How the inputs are read.
    pub source: SourceOptions,
    /// Replace a report that is there.
    pub force: bool,
    /// No progress.
    pub quiet: bool,
}

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Report {
    /// Where and when.
    pub machine: Machine,
    /// The inputs.
    pub sources: Vec<SourceRecord>,
    /// The body's name, or `plane`.
    pub body: String,
    /// The grid's exponent.
    pub m: u32,
    /// Columns and rows of level 0.
    pub size: (u32, u32),
    /// The exponent that a bake chooses.
    pub bake_m: u32,
    /// The step that a bake chooses, as an exponent; that of the kernels and codecs.
    pub step_exponent: i8,
    /// Threads of bakes and decodes.
    pub threads: usize,
    /// Every n-th sample of every n-th row was compared.
    pub every: usize,
    /// The steps, finest first, with the kernel `auto`.
    pub steps: Vec<Measured>,
    /// The kernels at the default step; none on a plane, whose nodes are the samples.
    pub kernels: Vec<Measured>,
    /// Ways to code the file of the default step.
    pub codecs: Vec<Codec>,
}

/// Measures, and writes `index.html`, `report.csv`, `codecs.csv` and the plots.
///
/// # Errors
/// What keeps a case from being baked or the folder from being written; then nothing is left.
pub fn run(inputs: &[String], options: &ReportOptions, stop: &AtomicBool) -> Result<Report, ToolError> {
    let folder = Folder::open(&options.output, options.force)?;
    let threads = options.source.threads;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        ToolError::usage(format!("--threads {threads}: {error}"), "the system grants the threads", "ask for fewer")
    })?;
    let report = pool.install(|| measure(inputs, options, &folder, stop)).map_err(|error| match error {
        ToolError::Interrupted => {
            ToolError::usage("interrupted", "a report is published whole or not at all", "run it again")
        }
        error => error,
    })?;
    let mut files = vec![("report.csv", csv::cases(&report)), ("codecs.csv", csv::codecs(&report))];
    let drawn = figures::all(&report);
    files.extend(drawn.iter().map(|figure| (figure.file, figure.svg.standalone())));
    // Last, so that a page never names a file that is not there.
    files.push(("index.html", page::html(&report, &drawn)));
    let stale: Vec<&str> = figures::NAMES.into_iter().filter(|name| files.iter().all(|file| file.0 != *name)).collect();
    folder.publish(&files, &stale)?;
    Ok(report)
}

fn measure(
    inputs: &[String],
    options: &ReportOptions,
    folder: &Folder,
    stop: &AtomicBool,
) -> Result<Report, ToolError> {
    let machine = Machine::here();
    let sources = open_sources(inputs, &options.source)?;
    let native = sources.native_step_m().map_or(DEFAULT_STEP_EXPONENT, |step_m| step_m.log2().round() as i8);
    let step_exponent = native.clamp(*STEP_EXPONENTS.start(), *STEP_EXPONENTS.end());
    let plan = plan(&sources, options.m, step_exponent)?;
    let samples = Samples::collect(&sources, &plan, options.source.memory_bytes / 4)?;
    let left = options.source.memory_bytes.saturating_sub(samples.bytes());
    let source = SourceOptions { memory_bytes: left, ..options.source.clone() };
    let bench = Bench { inputs, source: &source, plan: &plan, samples: &samples, folder, stop };
    let plane = options.source.body == Some(BodyChoice::Plane);
    let kernels: &[Resample] = if plane { &[] } else { &KERNELS };
    let progress = Progress::new("measuring", (STEP_EXPONENTS.count() + kernels.len()) as u64, options.quiet);
    let mut codecs = Vec::new();
    let mut steps = Vec::new();
    for exponent in STEP_EXPONENTS {
        let case = Case { step_exponent: exponent, resample: Resample::Auto };
        steps.push(bench.measure(case, |relief| {
            if exponent == step_exponent {
                codecs = compare(relief).map_err(ToolError::of_file(&folder.scratch("case.relief")))?;
            }
            Ok(())
        })?);
        progress.add(1);
    }
    let mut measured = Vec::new();
    for &resample in kernels {
        measured.push(bench.measure(Case { step_exponent, resample }, |_| Ok(()))?);
        progress.add(1);
    }
    Ok(Report {
        machine,
        sources: sources.describe(),
        body: match &sources.body {
            relief_formats::body::Body::Ellipsoid { name, .. } => name.clone(),
            relief_formats::body::Body::Plane { .. } => "plane".into(),
        },
        m: plan.grid.m,
        size: (plan.grid.width(0), plan.grid.height(0)),
        bake_m: sources.default_m(),
        step_exponent,
        threads: options.source.threads,
        every: samples.every,
        steps,
        kernels: measured,
        codecs,
    })
}

/// The grid that was asked for, or the finest that a bake would take with a bearable number of
/// tiles.
fn plan(sources: &SourceSet, m: Option<u32>, step_exponent: i8) -> Result<Plan, ToolError> {
    if m.is_some() {
        return Plan::new(sources, m, step_exponent);
    }
    let finest = sources.default_m().clamp(*M_RANGE.start(), *M_RANGE.end());
    let mut chosen = Plan::new(sources, Some(*M_RANGE.start()), step_exponent)?;
    for m in M_RANGE.start() + 1..=finest {
        let next = Plan::new(sources, Some(m), step_exponent)?;
        if next.tile_count() > TILE_LIMIT {
            break;
        }
        chosen = next;
    }
    Ok(chosen)
}
