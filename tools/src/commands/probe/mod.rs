//! `relief-bake probe`: heights at points.

mod answer;
mod stream;

use std::path::PathBuf;

use relief_formats::file::Relief;

use self::answer::Prober;
use crate::commands::Outcome;
use relief_front::error::ToolError;
use relief_front::stdout::print;

/// Height, bounds and position at a point, or at every point on standard input
#[derive(Debug, clap::Args)]
#[command(
    long_about = "Height, bounds and position at a point, or at every point on standard input.\n\n\
        The height is that of S_0, the surface bilinear between the nodes, in metres along the normal of \
        the body's ellipsoid (the reference that `relief-bake inspect` calls vertical). Longitudes and \
        latitudes are geodetic, in degrees; longitudes may take any number of turns. A plane is asked by \
        X Y of its own CRS.",
    after_long_help = "JSON keys: height_m; level; filled (a node around the point holds no measurement); bounds_m \
        [least, greatest] of S_0 over the 2 x 2 cells of the level around the point; ecef_m [x, y, z] \
        (Earth-centred; not for a plane).\n\
        With `-` each line `lon lat` of standard input gives one JSON object, in order; a line that \
        cannot be answered gives {\"line\": number, \"error\": reason}, and the exit code is then 1.\n\n\
        Examples:\n  relief-bake probe earth.relief 86.925 27.988\n  \
        relief-bake probe earth.relief -122.4 37.8 --level 2 --json\n  \
        relief-bake probe earth.relief - < points.txt > heights.jsonl"
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
    /// Level of the nodes between which to interpolate; 0 is the finest
    #[arg(long, value_name = "K", default_value_t = 0)]
    level: u32,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let in_file = ToolError::of_file(&args.file);
    let relief = Relief::open(&args.file).map_err(in_file)?;
    let prober = Prober::new(&relief, args.level)?;
    match (args.lon.as_str(), &args.lat) {
        ("-", None) => return stream::run(&prober, std::io::stdin(), in_file),
        ("-", Some(lat)) => {
            let remedy = "give `-` alone, or a longitude and a latitude";
            return Err(ToolError::usage(format!("- {lat}"), "`-` stands for lines on standard input", remedy));
        }
        (lon, None) => {
            let remedy = "give the second number, or `-` for lines on standard input";
            return Err(ToolError::usage(format!("{lon} alone"), "a point has two coordinates", remedy));
        }
        (lon, Some(lat)) => {
            let refused = |error: String| {
                ToolError::usage(error, prober.rule(), "correct the coordinates; `relief-bake inspect` shows the grid")
            };
            let point = answer::parse_point(&format!("{lon} {lat}")).map_err(refused)?;
            let place = prober.place(point).map_err(|error| refused(error.to_string()))?;
            let sample = prober.surface.sample(&place).map_err(in_file)?;
            let mut text = String::new();
            if args.json {
                prober.write_json(&mut text, point, &sample);
                text.push('\n');
            } else {
                prober.write_text(&mut text, point, &sample);
            }
            print(&text)?;
        }
    }
    Ok(Outcome::Good)
}
