//! `relief-bake diff`: where two files differ, and by how much.

mod compare;
mod map;
mod print;
mod tile;

use std::path::PathBuf;

use relief_formats::body::Body;
use relief_formats::file::Relief;

use self::compare::{Comparison, Side, compare};
use crate::commands::Outcome;
use relief_front::error::ToolError;
use relief_front::stdout;

/// Where two files differ, and by how much
#[derive(Debug, clap::Args)]
#[command(
    long_about = "Where two files of the same grid and body differ, and by how much.\n\n\
        Files of the same content (see content_id in `relief-bake inspect`) are equal at once; of others \
        only the tiles whose checksums differ are decoded. Differences are B - A in metres at the nodes; \
        where one file has no tile, its surface is interpolated from the coarser level. The RMS is over all \
        nodes of level 0.\n\n\
        Exit code 0: equal within the tolerance; 1: different; 2: cannot be compared. Without a tolerance any \
        difference of content counts, those of other planes and of the step too.",
    after_long_help = "Examples:\n  relief-bake diff old.relief new.relief\n  \
        relief-bake diff old.relief new.relief --tolerance 0.5 --json\n  \
        relief-bake diff old.relief new.relief --png where.png"
)]
pub struct Args {
    /// The first .relief file
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The second .relief file
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Largest height difference that counts as equal, metres
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    tolerance: f64,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
    /// Draw a map of the differences: red where B is higher, blue where it is lower
    #[arg(long, value_name = "OUT.png")]
    png: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    if !(args.tolerance.is_finite() && args.tolerance >= 0.0) {
        return Err(ToolError::usage(
            format!("--tolerance {}", args.tolerance),
            "a tolerance is a height in metres, 0 or more",
            "leave it out to find any difference",
        ));
    }
    let open = |path: &PathBuf| Relief::open(path).map_err(ToolError::of_file(path));
    let (a, b) = (open(&args.a)?, open(&args.b)?);
    comparable(&a, &b)?;
    let sides = [Side::new(&args.a, &a), Side::new(&args.b, &b)];
    let mut map = args.png.as_ref().map(|_| map::Map::new(a.grid()));
    let identical = a.header().content_id == b.header().content_id;
    let comparison = if identical { Comparison::identical(&sides) } else { compare(&sides, map.as_mut())? };
    let different = match args.tolerance {
        0.0 => !identical,
        tolerance => comparison.largest.is_some_and(|largest| largest.difference_m.abs() > tolerance),
    };
    if let (Some(path), Some(map)) = (&args.png, &map) {
        map.write(path)?;
    }
    stdout::print(&if args.json {
        format!("{}\n", print::json(&comparison, &a, args.tolerance, different))
    } else {
        print::text(&comparison, &a, args.tolerance, different)
    })?;
    Ok(if different { Outcome::Found } else { Outcome::Good })
}

/// Refuses files whose nodes are not at the same places.
fn comparable(a: &Relief, b: &Relief) -> Result<(), ToolError> {
    let refused = |what: String| {
        let rule = "two files are compared node by node: same m, same body, same place of a plane";
        Err(ToolError::usage(what, rule, "bake one of them again with the other's --m and --body"))
    };
    if a.header().m != b.header().m {
        return refused(format!("m is {} in A and {} in B", a.header().m, b.header().m));
    }
    match (a.body(), b.body()) {
        (Body::Ellipsoid { a_m, b_m, .. }, Body::Ellipsoid { a_m: other_a_m, b_m: other_b_m, .. }) => {
            if (a_m, b_m) != (other_a_m, other_b_m) {
                return refused(format!("the semi-axes are {a_m}, {b_m} m in A and {other_a_m}, {other_b_m} m in B"));
            }
        }
        (Body::Plane { .. }, Body::Plane { .. }) if a.body() == b.body() => {}
        (Body::Plane { .. }, Body::Plane { .. }) => return refused("the planes of A and B lie elsewhere".into()),
        _ => return refused("one file is a plane, the other a globe".into()),
    }
    Ok(())
}
