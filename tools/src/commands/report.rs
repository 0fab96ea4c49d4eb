//! `relief-bake report`: speed against error of steps, kernels and codecs.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::source_args::SourceArgs;
use crate::commands::Outcome;
use crate::report::{self, ReportOptions};
use crate::source::Resample;
use relief_front::error::ToolError;
use relief_front::stdout::print;

/// Speed against error of steps, kernels and codecs, as a page with plots and tables.
///
/// Bakes the inputs with steps from 1/64 to 8 m and with every kernel, and measures each file:
/// bytes, largest and RMS error, encode and decode speed. Writes index.html (needs nothing else),
/// report.csv, codecs.csv and the plots as SVG.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    relief-bake report etopo.tif -o report --vertical egm96\n  \
    relief-bake report moon.tif -o report --m 10\n  \
    relief-bake report local.tif -o report --body plane --vertical as-given --force")]
pub struct Args {
    /// Rasters: all that GDAL reads, /vsi paths too, and OpenEXR.
    #[arg(required = true)]
    inputs: Vec<String>,
    /// The folder to write; new or empty.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Map exponent 8..20; default: as for a bake, but at most what takes a minute or two.
    #[arg(long, value_name = "M")]
    m: Option<u32>,
    #[command(flatten)]
    source: SourceArgs,
    /// Replace a report that is there.
    #[arg(long)]
    force: bool,
    /// Print no progress.
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
///
/// # Errors
/// What kept it from running; then nothing is left behind.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let options = ReportOptions {
        output: args.output.clone(),
        m: args.m,
        source: args.source.options(Resample::Auto)?,
        force: args.force,
        quiet: args.quiet,
    };
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    // A second handler in one process is refused; then the default action, ending at once, stands.
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    report::run(&args.inputs, &options, &stop)?;
    if !args.quiet {
        print(&format!("{}\n", args.output.join("index.html").display()))?;
    }
    Ok(Outcome::Good)
}
