//! `reliefd report`: speed against error.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use relief_front::error::ToolError;
use relief_front::sheet::folder::Folder;
use relief_front::stderr::say;
use relief_front::stdout::print;
use relief_runtime::report::{Options, ReportError, run as measure, write};

use crate::Outcome;
use crate::errors::{of_render, open};
use crate::typed::SizeArg;

/// Speed against error: meshes by scheme and threshold, shadows by kernel and level
#[derive(Debug, clap::Args)]
#[command(
    long_about = "Speed against error: meshes by scheme and threshold, shadows by kernel and level.\n\n\
        Views from 10 m above the ground to far out are drawn with each threshold, and the drawn surface is \
        measured against the true one in f64; rays are compared with an oracle that uses no pyramid. The folder \
        gets one page (index.html), its plots (SVG) and tables (CSV). Everything runs on the CPU: counts and \
        errors are those of the GPU, times are not.",
    after_long_help = "Examples:\n  reliefd report earth.relief -o report\n  \
        reliefd report map.relief -o report --size 640x360 --quick --force"
)]
pub struct Args {
    /// The .relief file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The folder to write
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Pixels of the pictures whose meshes are measured
    #[arg(long, value_name = "WxH", default_value = "1920x1080")]
    size: SizeArg,
    /// A tenth of the points and rays
    #[arg(long)]
    quick: bool,
    /// Replace a report that is in the folder
    #[arg(long)]
    force: bool,
    /// Say nothing on standard error
    #[arg(long)]
    quiet: bool,
}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let planet = open(&args.file)?;
    // Said before the work, not after it.
    drop(Folder::open(&args.output, args.force)?);
    let name = args.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let usual = Options { size: args.size.0, ..Options::default() };
    let options = match args.quick {
        false => usual,
        true => Options { points: usual.points / 10, rays: usual.rays / 10, checked: usual.checked / 10, ..usual },
    };
    let shown = AtomicU32::new(u32::MAX);
    let progress = |what: &str, share: f64| {
        let percent = (share * 100.0) as u32;
        if !args.quiet && shown.swap(percent, Ordering::Relaxed) != percent {
            say(&format!("{percent:3} %  {what}"));
        }
    };
    let failed = |error| match error {
        ReportError::Render(error) => of_render(&args.file)(error),
        ReportError::Output(error) => error,
    };
    let report = measure(&planet, &name, &options, &progress).map_err(failed)?;
    write(&report, &args.output, args.force).map_err(failed)?;
    print(&format!(
        "{}: {} meshes, {} shadow kernels measured\n",
        args.output.join("index.html").display(),
        report.meshes.len(),
        report.shadows.len()
    ))?;
    Ok(Outcome::Good)
}
