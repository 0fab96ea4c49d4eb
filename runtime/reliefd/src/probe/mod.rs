//! `reliefd probe`: heights and sunlight at points, through the kernels.

mod answer;
mod kernels;
mod stream;

use std::path::PathBuf;

use relief_front::error::ToolError;
use relief_front::stdout::print;

use self::answer::{Prober, parse_point};
use crate::Outcome;
use crate::backend::BackendChoice;
use crate::light::SunArgs;

/// Height and sunlight at a point, or at every point on standard input
#[derive(Debug, clap::Args)]
#[command(
    long_about = "Height and sunlight at a point, or at every point on standard input.\n\n\
        The height is that of `relief-bake probe`, worked out by the kernels in f32. With a sun the answer \
        says how much of it a point on the ground sees, by a ray of the kernels on the same backend.",
    after_long_help = "JSON keys: height_m; level; filled (a node around the point holds no measurement); bounds_m \
        [least, greatest] of S_0 over the 2 x 2 cells of the level around the point; lit (0 in shadow to 1; \
        only with a sun).\n\
        With `-` each line `lon lat` of standard input gives one JSON object, in order; a line that \
        cannot be answered gives {\"line\": number, \"error\": reason}, and the exit code is then 1.\n\n\
        Examples:\n  reliefd probe earth.relief 86.925 27.988\n  \
        reliefd probe earth.relief 86.925 27.988 --time 2026-06-21T03:00:00Z --json\n  \
        reliefd probe earth.relief - --sun 60,10 < points.txt > lit.jsonl"
)]
pub struct Args {
    /// The .relief file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Longitude in degrees east (a plane: X), or `-` for lines on standard input
    #[arg(value_name = "LON", allow_negative_numbers = true)]
    lon: String,
    /// Geodetic latitude in degrees north (a plane: Y)
    #[arg(value_name = "LAT", allow_negative_numbers = true)]
    lat: Option<String>,
    #[command(flatten)]
    sun: SunArgs,
    /// The sun is a disk, not a point
    #[arg(long)]
    soft: bool,
    /// Level of the nodes between which to interpolate; 0 is the finest
    #[arg(long, value_name = "K", default_value_t = 0)]
    level: u32,
    /// Where the kernels run
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let point = match (args.lon.as_str(), &args.lat) {
        ("-", None) => None,
        ("-", Some(lat)) => {
            let remedy = "give `-` alone, or a longitude and a latitude";
            return Err(ToolError::usage(format!("- {lat}"), "`-` stands for lines on standard input", remedy));
        }
        (lon, None) => {
            let remedy = "give the second number, or `-` for lines on standard input";
            return Err(ToolError::usage(format!("{lon} alone"), "a point has two coordinates", remedy));
        }
        (lon, Some(lat)) => Some(format!("{lon} {lat}")),
    };
    let mut prober = Prober::new(args)?;
    let Some(point) = point else { return stream::run(&mut prober, std::io::stdin().lock()) };
    let rule = prober.rule();
    let refused = |error: String| {
        ToolError::usage(error, rule, "correct the coordinates; `relief-bake inspect` shows where the file lies")
    };
    let place = parse_point(&point).and_then(|point| prober.place(point)).map_err(refused)?;
    for answer in prober.answers(&[place])? {
        print(&if args.json { answer.json() + "\n" } else { answer.text() })?;
    }
    Ok(Outcome::Good)
}
