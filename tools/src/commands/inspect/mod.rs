//! `relief-bake inspect`: what a file holds, from its header, metadata and index alone.

mod facts;
mod text;

use std::path::PathBuf;

use relief_formats::file::Relief;

use crate::commands::Outcome;
use relief_front::error::ToolError;
use relief_front::stdout::print;

/// What a file holds: size, body, heights, planes, sources
#[derive(Debug, clap::Args)]
#[command(
    long_about = "What a file holds: its grid, body, heights, planes and sources.\n\n\
        Reads the header, the metadata and the index; no tile is decoded. `relief-bake validate` \
        checks the tiles. Heights are in metres above the body's ellipsoid, unless the vertical \
        reference says otherwise.",
    after_long_help = "JSON keys (--json): m, width, height (nodes of level 0), step_m, bound_m (largest quantisation \
        error), body {name, a_m, b_m} (a plane: {name, crs, x0, y0, dx, dy} in units of its CRS), vertical, \
        levels, tiles, min_m, max_m, south_pole_m, north_pole_m (a plane: its first and last node), \
        planes {name: {bytes, raw_bytes}}, file_bytes, content_id, sources.\n\
        raw_bytes counts every sample once, in the smallest integer type that holds the file's range.\n\n\
        Examples:\n  relief-bake inspect earth.relief\n  relief-bake inspect moon.relief --json | jq .planes"
)]
pub struct Args {
    /// The .relief file
    #[arg(value_name = "FILE")]
    file: PathBuf,
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
    let facts = facts::Facts::of(&relief).map_err(in_file)?;
    if args.json {
        print(&format!("{}\n", facts::json(&relief, &facts)))?;
    } else {
        print(&text::text(&relief, &facts))?;
    }
    Ok(Outcome::Good)
}
