//! `relief-bake export`: a plane as a GeoTIFF, or the patch mesh as glTF.

mod model;

use std::path::PathBuf;

use relief_formats::file::Relief;
use relief_formats::tiles::Tiles;

use crate::cog::write_cog;
use crate::commands::Outcome;
use crate::lattice::{Bounds, Lattice, PlaneChoice};
use relief_front::error::ToolError;
use relief_front::stdout::print;

/// A plane as a cloud-optimised GeoTIFF, or the patch mesh as glTF
#[derive(Debug, clap::Args)]
#[command(
    long_about = "A plane as a cloud-optimised GeoTIFF (.tif), or the patch mesh as binary glTF (.glb).\n\n\
        The pixels' centres of the GeoTIFF are the nodes: a globe's outer rows lie on the poles, and the \
        raster ends half a pixel beyond them. Values are metres, exactly those of the file (Int16 or Int32 \
        where the step is whole metres, else Float32); voids are nodata. Extremes have a pixel for each \
        2 x 2 cells.\n\n\
        The mesh has the relief's heights at its vertices and a shaded texture; lengths are metres.",
    after_long_help = "Examples:\n  relief-bake export earth.relief -o earth.tif\n  \
        relief-bake export earth.relief -o alps.tif --window 5,43,17,49 --level 1\n  \
        relief-bake export moon.relief -o bounds.tif --plane hext-max --level 2\n  \
        relief-bake export moon.relief -o moon.glb"
)]
pub struct Args {
    /// The .relief file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// What to write: .tif for a GeoTIFF, .glb for the mesh
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Level of the nodes; 0 is the finest [default: 0]
    #[arg(long, value_name = "K")]
    level: Option<u32>,
    /// What to write into the GeoTIFF [default: nodes]
    #[arg(long, value_name = "PLANE", value_enum)]
    plane: Option<PlaneChoice>,
    /// Part of the map: degrees (a plane: CRS units); east may lie beyond the antimeridian
    #[arg(long, value_name = "W,S,E,N", allow_hyphen_values = true)]
    window: Option<Bounds>,
    /// Replace an output that exists
    #[arg(long)]
    force: bool,
}

/// Cache of decoded tiles.
const CACHE_BYTES: u64 = 256 << 20;

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let relief = Relief::open(&args.file).map_err(ToolError::of_file(&args.file))?;
    let tiles = Tiles::new(&relief, CACHE_BYTES);
    let extension = args.output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("tif" | "tiff") => raster(args, &relief, &tiles)?,
        Some("glb") => {
            if args.level.is_some() || args.plane.is_some() || args.window.is_some() {
                return Err(ToolError::usage(
                    "--level, --plane or --window with a .glb output",
                    "the mesh is exported whole, with the heights of S_0",
                    "leave these out, or name a .tif output",
                ));
            }
            model::write(&args.file, &tiles, &args.output, args.force)?;
        }
        _ => {
            return Err(ToolError::usage(
                format!("--output {}", args.output.display()),
                "the name ends in .tif or .glb and so says what to write",
                "name OUT.tif for a plane or OUT.glb for the mesh",
            ));
        }
    }
    Ok(Outcome::Good)
}

fn raster(args: &Args, relief: &Relief, tiles: &Tiles<'_>) -> Result<(), ToolError> {
    let (level, coarsest) = (args.level.unwrap_or(0), relief.grid().root_level());
    if level > coarsest {
        return Err(ToolError::usage(
            format!("--level {level}"),
            format!("the file has the levels 0 (finest) to {coarsest}"),
            "ask for one of these levels; `relief-bake inspect` lists them",
        ));
    }
    let lattice = Lattice::new(tiles, level, args.plane.unwrap_or(PlaneChoice::Nodes));
    let samples = lattice.samples();
    let bounds = args.window.unwrap_or_else(|| Bounds::whole(samples)).ordered(samples.wraps)?;
    let rectangle = bounds.samples(samples).ok_or_else(|| {
        ToolError::usage(
            format!("--window {},{},{},{}", bounds.west, bounds.south, bounds.east, bounds.north),
            "a window holds at least one sample of the level",
            "widen it or give a finer --level; `relief-bake inspect` shows where the file lies",
        )
    })?;
    let (bytes, kind) = write_cog((&args.file, relief), &lattice, rectangle, &args.output, args.force)?;
    print(&format!(
        "{}: {} x {} pixels, {} of level {level}, {}, {bytes} bytes\n",
        args.output.display(),
        rectangle.columns,
        rectangle.rows,
        lattice.plane().name(),
        kind.name(),
    ))
}
