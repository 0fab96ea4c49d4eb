//! `relief-bake bake`: from elevation rasters to a `.relief` file.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::ValueEnum;
use relief_formats::mesh::MeshLayout;

use super::Outcome;
use super::source_args::{SourceArgs, refusal};
use crate::bake::{BakeOptions, bake};
use crate::source::Resample;
use relief_front::error::ToolError;
use relief_front::stdout::print;

/// Bake elevation rasters into one .relief file.
///
/// Several inputs may overlap: later ones win where they have data, and finer levels exist only
/// where a source is fine. Earth needs to know what its heights are measured from (--vertical).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    relief-bake bake etopo.tif -o earth.relief --vertical egm96\n  \
    relief-bake bake lola.tif -o moon.relief --m 13\n  \
    relief-bake bake world.tif alps.tif -o alps.relief --vertical egm96\n  \
    relief-bake bake local.tif -o local.relief --body plane --vertical as-given\n  \
    relief-bake bake height.exr -o earth.relief --bounds -180,-90,180,90 --channel height --vertical ellipsoid")]
pub struct Args {
    /// Rasters: all that GDAL reads, /vsi paths too, and OpenEXR.
    #[arg(required = true)]
    inputs: Vec<String>,
    /// The file to write.
    #[arg(short, long, value_name = "FILE.relief")]
    output: PathBuf,
    /// Map exponent 8..20: 2^(m+1) x 2^m nodes; default: no coarser than the finest source.
    #[arg(long, value_name = "M")]
    m: Option<u32>,
    /// Height step in metres, a power of two; default: 1 for integer metres (lossless), else 2^-4.
    #[arg(long, value_name = "METRES", conflicts_with = "max_error", value_parser = parse_positive)]
    step: Option<f64>,
    /// Largest quantisation error in metres; the step is twice that, rounded down to a power of two.
    #[arg(long, value_name = "METRES", value_parser = parse_positive)]
    max_error: Option<f64>,
    /// Kernel; auto: area average where the source is finer than the grid, else cubic.
    #[arg(long, value_enum, default_value = "auto")]
    resample: ResampleArg,
    #[command(flatten)]
    source: SourceArgs,
    /// Layout of the patch mesh.
    #[arg(long, value_enum, default_value = "aligned")]
    layout: LayoutArg,
    /// Go on from the work file FILE.relief.part of an interrupted bake with the same options.
    #[arg(long)]
    resume: bool,
    /// Replace the output if it exists.
    #[arg(long)]
    force: bool,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
    /// Print no progress.
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ResampleArg {
    Auto,
    Nearest,
    Bilinear,
    Cubic,
    Lanczos,
    Average,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LayoutArg {
    Aligned,
    Paper,
}

/// Bakes, and prints what was written.
///
/// # Errors
/// What kept the file from being written.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let options = args.options()?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    // A second handler in one process is refused; then the default action, ending at once, stands.
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    let report = bake(&args.inputs, &options, &stop)?;
    let header = &report.header;
    if args.json {
        let facts = serde_json::json!({
                "file": args.output.display().to_string(),
                "file_bytes": header.file_bytes,
                "m": header.m,
                "step_m": header.step_m(),
                "bound_m": header.step_m() / 2.0,
                "tiles": header.tile_count,
                "min_m": f64::from(header.min_q) * header.step_m(),
                "max_m": f64::from(header.max_q) * header.step_m(),
                "content_id": header.content_id.iter().map(|b| format!("{b:02x}")).collect::<String>(),
                "resumed_blocks": report.resumed_blocks,
        });
        print(&format!("{facts}\n"))?;
    } else if !args.quiet {
        let grid = header.grid();
        print(&format!(
            "{}: m = {}, {} x {} nodes, step {} m, {} tiles, {:.1} MB, heights {} to {} m\n",
            args.output.display(),
            header.m,
            grid.width(0),
            grid.height(0),
            header.step_m(),
            header.tile_count,
            header.file_bytes as f64 / 1e6,
            f64::from(header.min_q) * header.step_m(),
            f64::from(header.max_q) * header.step_m(),
        ))?;
    }
    Ok(Outcome::Good)
}

impl Args {
    fn options(&self) -> Result<BakeOptions, ToolError> {
        let step_exponent = match (self.step, self.max_error) {
            (Some(step), _) => {
                let k = step.log2();
                if k.fract() != 0.0 {
                    return Err(ToolError::usage(
                        format!("--step {step}"),
                        "a step is a power of two, so that heights are exact",
                        format!("--step {}, or --max-error {}", k.floor().exp2(), step / 2.0),
                    ));
                }
                Some(k)
            }
            (None, Some(error)) => Some((2.0 * error).log2().floor()),
            (None, None) => None,
        };
        Ok(BakeOptions {
            output: self.output.clone(),
            m: self.m,
            step_exponent: step_exponent.map(|k| k.clamp(-128.0, 127.0) as i8),
            source: self.source.options(match self.resample {
                ResampleArg::Auto => Resample::Auto,
                ResampleArg::Nearest => Resample::Nearest,
                ResampleArg::Bilinear => Resample::Bilinear,
                ResampleArg::Cubic => Resample::Cubic,
                ResampleArg::Lanczos => Resample::Lanczos,
                ResampleArg::Average => Resample::Average,
            })?,
            layout: match self.layout {
                LayoutArg::Aligned => MeshLayout::Aligned,
                LayoutArg::Paper => MeshLayout::Paper,
            },
            resume: self.resume,
            force: self.force,
            quiet: self.quiet,
        })
    }
}

fn parse_positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v > 0.0 && v.is_finite() => Ok(v),
        _ => Err(refusal("it is a positive number of metres", "give one, such as 0.5")),
    }
}
