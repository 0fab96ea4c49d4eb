//! `relief-bake preview`: a picture of a file.

mod sample;

use std::path::{Path, PathBuf};

use relief_formats::file::{FormatError, Relief};
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

use self::sample::{Canvas, Raster};
use crate::commands::Outcome;
use crate::lattice::{Bounds, Lattice, PlaneChoice};
use crate::source::SeaLevel;
use relief_front::error::ToolError;
use relief_front::picture::{
    ColourMap, ColourMapInput, PictureInput, RgbImage, Tint, colour_map, shaded_relief, write_png,
};
use relief_front::stdout::print;

/// A picture: hypsometric tints and shading, or a colour map of another plane
#[derive(Debug, clap::Args)]
#[command(
    long_about = "A picture: hypsometric tints and shading of the heights, or a colour map of another plane.\n\n\
        Reads the level that matches the size, so that a large file costs no more than a small one. \
        A globe is drawn equirectangular with north at the top, tinted by height above the sea where the \
        bake added EGM96; of a plane the measured part is drawn. Voids are hatched grey. An existing PNG \
        of that name is replaced.",
    after_long_help = "Examples:\n  relief-bake preview earth.relief -o earth.png --size 2048\n  \
        relief-bake preview earth.relief -o alps.png --window 5,43,17,49\n  \
        relief-bake preview moon.relief -o deviation.png --plane deviation"
)]
pub struct Args {
    /// The .relief file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The PNG to write
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    /// Width of the picture in pixels, 16 to 16384 [default: the window's nodes, at most 2048]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=16384))]
    size: Option<u32>,
    /// What to draw
    #[arg(long, value_name = "PLANE", value_enum, default_value = "mip")]
    plane: PlaneChoice,
    /// Part of the map: degrees (a plane: CRS units); east may lie beyond the antimeridian
    #[arg(long, value_name = "W,S,E,N", allow_hyphen_values = true)]
    window: Option<Bounds>,
}

/// Cache of decoded tiles.
const CACHE_BYTES: u64 = 256 << 20;
/// Up to here pixels of heights are averaged from 2 x 2 samples.
const LARGEST_SUPERSAMPLED: u32 = 8192;
const DEFAULT_SIZE: u32 = 2048;

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let in_file = ToolError::of_file(&args.file);
    let relief = Relief::open(&args.file).map_err(in_file)?;
    refuse_other_files(&args.output)?;
    let tiles = Tiles::new(&relief, CACHE_BYTES);
    let finest = Lattice::new(&tiles, 0, args.plane);
    let usual = usual_bounds(&tiles, &finest).map_err(in_file)?;
    let bounds = args.window.unwrap_or(usual).ordered(finest.samples().wraps)?;
    if !finest.samples().wraps && bounds.samples(finest.samples()).is_none() {
        return Err(ToolError::usage(
            format!("--window: {},{},{},{}", bounds.west, bounds.south, bounds.east, bounds.north),
            "a window overlaps the file's square",
            "see `relief-bake inspect` for where it lies",
        ));
    }
    let nodes_across = (bounds.east - bounds.west) / finest.samples().frame[2];
    let size = args.size.unwrap_or_else(|| DEFAULT_SIZE.min(nodes_across as u32)).max(16);
    let supersample = if args.plane.is_height() && size <= LARGEST_SUPERSAMPLED { 2 } else { 1 };
    let canvas = Canvas::new(&relief, bounds, size, supersample)?;
    let level = canvas.level(&relief);
    let mut raster = canvas.draw(&Lattice::new(&tiles, level, args.plane)).map_err(in_file)?;
    let sea = args.plane.is_height().then(|| sea_level(&relief)).flatten();
    if let Some(sea) = &sea {
        canvas.above_sea(&mut raster, sea);
    }
    let (image, caption) = match args.plane {
        PlaneChoice::Nodes | PlaneChoice::Mip => heights(&relief, &raster, supersample)?,
        plane => values(plane, &raster)?,
    };
    write_png(&args.output, &image)?;
    print(&format!(
        "{}: {} x {} pixels, {} of level {level}{caption}{}\n",
        args.output.display(),
        image.width,
        image.height,
        args.plane.name(),
        if sea.is_some() { " above sea level (EGM96)" } else { "" },
    ))?;
    Ok(Outcome::Good)
}

/// A shaded picture of part of a file, `size` pixels wide, for a texture.
///
/// # Errors
/// A damaged tile of the file at `input`, or a picture too large.
pub fn shaded(input: &Path, tiles: &Tiles<'_>, bounds: Bounds, size: u32) -> Result<RgbImage, ToolError> {
    let relief = tiles.relief();
    let canvas = Canvas::new(relief, bounds, size, 2)?;
    let lattice = Lattice::new(tiles, canvas.level(relief), PlaneChoice::Mip);
    let mut raster = canvas.draw(&lattice).map_err(ToolError::of_file(input))?;
    if let Some(sea) = sea_level(relief) {
        canvas.above_sea(&mut raster, &sea);
    }
    Ok(heights(relief, &raster, 2)?.0)
}

/// The sea of a file whose heights had EGM96 added.
fn sea_level(relief: &Relief) -> Option<SeaLevel> {
    relief.metadata().vertical.contains("EGM96").then(SeaLevel::egm96).flatten()
}

/// What a picture shows unless it is told: all of a globe, the measured part of a plane.
fn usual_bounds(tiles: &Tiles<'_>, finest: &Lattice<'_>) -> Result<Bounds, FormatError> {
    let whole = Bounds::whole(finest.samples());
    let grid = tiles.relief().grid();
    if !grid.plane {
        return Ok(whole);
    }
    let filled = tiles.filled(TileKey::new(grid.root_level(), 0, 0))?;
    let measured = || (0..TILE_NODES * TILE_NODES).filter(|&k| !filled[k]).map(|k| (k % TILE_NODES, k / TILE_NODES));
    // A coarse node more on each side: the border lies somewhere between two.
    let span = |of: fn((usize, usize)) -> usize| {
        let (low, high) = (measured().map(of).min().unwrap_or(0), measured().map(of).max().unwrap_or(TILE_NODES));
        let share = |node: usize| node as f64 / (TILE_NODES - 1) as f64;
        (share(low.saturating_sub(1)), share((high + 1).min(TILE_NODES - 1)))
    };
    let ((west, east), (south, north)) = (span(|(x, _)| x), span(|(_, y)| y));
    let (across, up) = (whole.east - whole.west, whole.north - whole.south);
    Ok(Bounds {
        west: whole.west + across * west,
        east: whole.west + across * east,
        south: whole.south + up * south,
        north: whole.south + up * north,
    })
}

fn heights(relief: &Relief, raster: &Raster, supersample: u32) -> Result<(RgbImage, String), ToolError> {
    let image = shaded_relief(&PictureInput {
        width: raster.width,
        height: raster.height,
        heights_m: &raster.values,
        cell_east_m: &raster.cell_east_m,
        cell_north_m: raster.cell_north_m,
        wraps: raster.wraps,
        tint: Tint::of(relief.body()),
        supersample: supersample as usize,
    });
    let range = raster.values.iter().filter(|v| !v.is_nan()).fold(None, |range: Option<(f32, f32)>, &v| {
        let (low, high) = range.unwrap_or((v, v));
        Some((low.min(v), high.max(v)))
    });
    let caption = range.map_or_else(|| ", all void".into(), |(low, high)| format!(", {low:.0} to {high:.0} m"));
    Ok((image.map_err(misfit)?, caption))
}

fn values(plane: PlaneChoice, raster: &Raster) -> Result<(RgbImage, String), ToolError> {
    let flags = plane == PlaneChoice::Filled;
    let (image, [low, high]) = colour_map(&ColourMapInput {
        width: raster.width,
        height: raster.height,
        values: &raster.values,
        map: ColourMap::Sequential,
        range: flags.then_some([0.0, 1.0]),
        legend: !flags,
    })
    .map_err(misfit)?;
    let caption =
        if flags { ", bright where filled".into() } else { format!(", colours from {low:.2} to {high:.2} m") };
    Ok((image, caption))
}

/// Pictures of a few samples only, which the checks above leave out.
fn misfit(error: relief_front::picture::PictureError) -> ToolError {
    ToolError::usage(error.to_string(), "a picture has at least one pixel each way", "give a larger --size or --window")
}

/// An existing picture is replaced; anything else of that name is somebody's data.
fn refuse_other_files(path: &Path) -> Result<(), ToolError> {
    const SIGNATURE: &[u8; 8] = b"\x89PNG\r\n\x1a\n";
    let mut head = Vec::new();
    if let Ok(file) = std::fs::File::open(path) {
        use std::io::Read as _;
        // What cannot be read (a folder) is refused as not being a picture.
        let _ = file.take(8).read_to_end(&mut head);
        if head != SIGNATURE {
            return Err(ToolError::usage(
                format!("{} exists and is no PNG", path.display()),
                "only a picture is replaced",
                "name another output, or remove the file first",
            ));
        }
    }
    Ok(())
}
