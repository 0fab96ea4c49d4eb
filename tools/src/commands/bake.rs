//! `relief-bake bake`: from elevation rasters to a `.relief` file.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::ValueEnum;
use relief_formats::mesh::MeshLayout;

use super::Outcome;
use crate::bake::{BakeOptions, bake};
use crate::error::ToolError;
use crate::source::{BodyChoice, Fill, Registration, Resample, SourceOptions, Unit, Vertical};

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
    /// earth, moon, mars, semi-axes A,B in metres, or plane; default: from the source's CRS.
    #[arg(long, value_parser = parse_body)]
    body: Option<BodyChoice>,
    /// Height step in metres, a power of two; default: 1 for integer metres (lossless), else 2^-4.
    #[arg(long, value_name = "METRES", conflicts_with = "max_error", value_parser = parse_positive)]
    step: Option<f64>,
    /// Largest quantisation error in metres; the step is twice that, rounded down to a power of two.
    #[arg(long, value_name = "METRES", value_parser = parse_positive)]
    max_error: Option<f64>,
    /// What heights are measured from: ellipsoid, egm96 (added), a geoid grid PATH.gtx (added), as-given.
    #[arg(long, value_parser = parse_vertical)]
    vertical: Option<Vertical>,
    /// Kernel; auto: area average where the source is finer than the grid, else cubic.
    #[arg(long, value_enum, default_value = "auto")]
    resample: ResampleArg,
    /// Stored value that means void; replaces the file's own tag.
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    nodata: Option<f64>,
    /// Nodes without data: none (0 m, marked), interpolate, or a height in metres.
    #[arg(long, value_parser = parse_fill, default_value = "none", allow_negative_numbers = true)]
    fill: Fill,
    /// Height units per stored unit; replaces the file's own tag.
    #[arg(long, allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Height of the stored zero; replaces the file's own tag.
    #[arg(long, allow_negative_numbers = true)]
    offset: Option<f64>,
    /// Unit of the heights; replaces the file's own tag.
    #[arg(long, value_enum)]
    unit: Option<UnitArg>,
    /// West, south, east, north in degrees, for inputs without georeference.
    #[arg(long, value_name = "W,S,E,N", value_parser = parse_bounds, allow_hyphen_values = true)]
    bounds: Option<[f64; 4]>,
    /// What the bounds are: edges of cells, or the outermost samples.
    #[arg(long, value_enum)]
    registration: Option<RegistrationArg>,
    /// EXR channel.
    #[arg(long, value_name = "NAME")]
    channel: Option<String>,
    /// Layout of the patch mesh.
    #[arg(long, value_enum, default_value = "aligned")]
    layout: LayoutArg,
    /// Threads; default: all cores. The bytes do not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Memory to stay within, such as 512MiB or 2GiB.
    #[arg(long, value_name = "BYTES", default_value = "1GiB", value_parser = parse_bytes)]
    memory: u64,
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
enum UnitArg {
    M,
    Ft,
    UsFt,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RegistrationArg {
    Cell,
    Node,
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
        println!(
            "{}",
            serde_json::json!({
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
            })
        );
    } else if !args.quiet {
        let grid = header.grid();
        println!(
            "{}: m = {}, {} x {} nodes, step {} m, {} tiles, {:.1} MB, heights {} to {} m",
            args.output.display(),
            header.m,
            grid.width(0),
            grid.height(0),
            header.step_m(),
            header.tile_count,
            header.file_bytes as f64 / 1e6,
            f64::from(header.min_q) * header.step_m(),
            f64::from(header.max_q) * header.step_m(),
        );
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
        let threads = self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, Into::into));
        if threads == 0 {
            return Err(ToolError::usage("--threads 0", "at least one thread", "leave --threads out to use all cores"));
        }
        Ok(BakeOptions {
            output: self.output.clone(),
            m: self.m,
            step_exponent: step_exponent.map(|k| k.clamp(-128.0, 127.0) as i8),
            source: SourceOptions {
                nodata: self.nodata,
                scale: self.scale,
                offset: self.offset,
                unit: self.unit.map(|u| match u {
                    UnitArg::M => Unit::M,
                    UnitArg::Ft => Unit::Ft,
                    UnitArg::UsFt => Unit::UsFt,
                }),
                bounds: self.bounds,
                registration: self.registration.map(|r| match r {
                    RegistrationArg::Cell => Registration::Cell,
                    RegistrationArg::Node => Registration::Node,
                }),
                channel: self.channel.clone(),
                vertical: self.vertical.clone(),
                body: self.body,
                resample: match self.resample {
                    ResampleArg::Auto => Resample::Auto,
                    ResampleArg::Nearest => Resample::Nearest,
                    ResampleArg::Bilinear => Resample::Bilinear,
                    ResampleArg::Cubic => Resample::Cubic,
                    ResampleArg::Lanczos => Resample::Lanczos,
                    ResampleArg::Average => Resample::Average,
                },
                fill: self.fill,
                memory_bytes: self.memory,
                threads,
            },
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

/// What clap prints after the value that it names.
fn refusal(rule: &str, remedy: &str) -> String {
    format!("\n  rule: {rule}\n  remedy: {remedy}")
}

fn parse_positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v > 0.0 && v.is_finite() => Ok(v),
        _ => Err(refusal("it is a positive number of metres", "give one, such as 0.5")),
    }
}

fn parse_body(text: &str) -> Result<BodyChoice, String> {
    Ok(match text {
        "earth" => BodyChoice::Earth,
        "moon" => BodyChoice::Moon,
        "mars" => BodyChoice::Mars,
        "plane" => BodyChoice::Plane,
        axes => match parse_numbers::<2>(axes) {
            Some([a, b]) if a > 0.0 && b > 0.0 => BodyChoice::Axes(a, b),
            _ => {
                let rule = "a body is earth, moon, mars, plane, or two semi-axes A,B in metres";
                return Err(refusal(rule, "name one, such as --body moon or --body 6051800,6051800"));
            }
        },
    })
}

fn parse_vertical(text: &str) -> Result<Vertical, String> {
    Ok(match text {
        "ellipsoid" => Vertical::Ellipsoid,
        "egm96" => Vertical::Egm96,
        "as-given" => Vertical::AsGiven,
        path if path.contains('.') => Vertical::Gtx(path.into()),
        _ => {
            let rule = "it is ellipsoid, egm96, as-given, or the path of a geoid grid such as PATH.gtx";
            return Err(refusal(rule, "say --vertical egm96 for heights above sea level"));
        }
    })
}

fn parse_fill(text: &str) -> Result<Fill, String> {
    Ok(match text {
        "none" => Fill::None,
        "interpolate" => Fill::Interpolate,
        metres => match metres.parse::<f64>() {
            Ok(v) if v.is_finite() => Fill::Constant(v),
            _ => return Err(refusal("a fill is none, interpolate, or a height in metres", "say --fill none")),
        },
    })
}

fn parse_bounds(text: &str) -> Result<[f64; 4], String> {
    let remedy = "give them as in --bounds=-180,-90,180,90";
    parse_numbers(text).ok_or_else(|| refusal("bounds are four finite numbers of degrees W,S,E,N", remedy))
}

fn parse_numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|t| t.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect();
    numbers?.try_into().ok()
}

/// Bytes with an optional binary or decimal suffix.
pub(crate) fn parse_bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor: f64 = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kib" => 1024.0,
        "m" | "mib" => 1024.0 * 1024.0,
        "g" | "gib" => 1024.0 * 1024.0 * 1024.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        _ => return Err(refusal("bytes, or a number with KiB, MiB, GiB, kB, MB or GB", "write it as 512MiB")),
    };
    match digits.trim().parse::<f64>() {
        Ok(v) if v >= 1.0 && v * factor < 1e18 => Ok((v * factor) as u64),
        _ => Err(refusal("it is a positive number of bytes", "write it as 512MiB")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_with_suffixes() {
        assert_eq!(parse_bytes("1GiB"), Ok(1 << 30));
        assert_eq!(parse_bytes("1.5MB"), Ok(1_500_000));
        assert_eq!(parse_bytes("4096"), Ok(4096));
        for bad in ["", "-1", "0", "12XB", "GiB", "nan"] {
            assert!(parse_bytes(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn words_of_the_command_line() {
        assert_eq!(parse_body("6378137,6356752"), Ok(BodyChoice::Axes(6_378_137.0, 6_356_752.0)));
        assert!(parse_body("pluto").is_err());
        assert_eq!(parse_fill("-3.5"), Ok(Fill::Constant(-3.5)));
        assert!(parse_fill("nan").is_err());
        assert_eq!(parse_vertical("geoid/x.gtx"), Ok(Vertical::Gtx("geoid/x.gtx".into())));
        assert!(parse_vertical("msl").is_err());
        assert_eq!(parse_bounds("-180,-90,180,90"), Ok([-180.0, -90.0, 180.0, 90.0]));
        assert!(parse_bounds("1,2,3").is_err());
    }
}
