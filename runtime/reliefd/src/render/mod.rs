//! `reliefd render`: one frame, and what belongs to it.

mod stats;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_front::error::ToolError;
use relief_front::picture::{RgbImage, write_png};
use relief_front::publish::publish;
use relief_front::stderr::say;
use relief_front::stdout::print;
use relief_runtime::frame::{Frame, Renderer, Settings};
use relief_runtime::planet::Planet;
use relief_runtime::view::View;

use crate::Outcome;
use crate::backend::{Backend, BackendChoice};
use crate::errors::{of_render, open};
use crate::mesh::glb;
use crate::output::{check_name, write_grey_png};
use crate::view_args::ViewArgs;

/// A frame: adaptive relief, shaded and in the sun's light
#[derive(Debug, clap::Args)]
#[command(
    long_about = "A frame: adaptive relief, shaded and in the sun's light.\n\n\
        The camera stands at a height above the ellipsoid (a plane: at X,Y of the CRS, above 0 m). Heading \
        turns clockwise from north; pitch is 0 at the horizontal and -90 straight down, which is the \
        default; straight down, heading says what is up in the picture. Without --sun and --time the light \
        comes from the north-west, 45 degrees high, as on maps. Outputs that exist are replaced.",
    after_long_help = "Exit code 1: tiles were still missing after --wait, or the mesh has holes; the frame is written \
        all the same.\n\n\
        Examples:\n  \
        reliefd render earth.relief --camera 86.925,27.6,9500,0,-8 --fov 50 --size 1920x1080 --sun 150,10 --out everest.png\n  \
        reliefd render moon.relief --camera 0,-60,400000 --size 1024x1024 --overlay wireframe --out moon.png --stats\n  \
        reliefd render map.relief --camera 500500,4000700,900,45,-30 --size 800x600 --sun 135,12 --out map.png --mesh map.glb"
)]
pub struct Args {
    /// The .relief file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    view: ViewArgs,
    /// Where the kernels run
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// Longest time to wait for tiles, seconds
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    wait: f64,
    /// The picture to write
    #[arg(short, long, value_name = "FRAME.png")]
    out: PathBuf,
    /// Also write the frame's mesh: metres east, up and south of the camera's foot
    #[arg(long, value_name = "OUT.glb")]
    mesh: Option<PathBuf>,
    /// Also write how much of the sun each pixel sees: 0 shadow (and sky), 255 lit
    #[arg(long, value_name = "SHADOW.png")]
    mask: Option<PathBuf>,
    /// Print one JSON object: triangles, passes, tiles, milliseconds
    #[arg(long)]
    stats: bool,
}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    check(args)?;
    let began = Instant::now();
    let planet = open(&args.file)?;
    let view = args.view.view(&planet)?;
    let settings = args.view.settings();
    let opened = began.elapsed();
    let backend = Backend::find(args.backend)?;
    let mut renderer = backend.renderer(Arc::clone(&planet), &args.file)?;
    let wait = Duration::from_secs_f64(args.wait);
    let frame = renderer.render_until_complete(&view, &settings, wait).map_err(of_render(&args.file))?;
    let complete = began.elapsed();
    write(args, &planet, &mut *renderer, (&view, &settings), &frame)?;
    if args.stats {
        print(&stats::json(args, &backend, &frame, [opened, complete]))?;
    }
    Ok(judged(&frame))
}

/// What need not wait for the file.
fn check(args: &Args) -> Result<(), ToolError> {
    check_name("--out", &args.out, &["png"])?;
    if let Some(mesh) = &args.mesh {
        check_name("--mesh", mesh, &["glb"])?;
    }
    if let Some(mask) = &args.mask {
        check_name("--mask", mask, &["png"])?;
    }
    if !(0.0..=86_400.0).contains(&args.wait) {
        return Err(ToolError::usage(
            format!("--wait {}", args.wait),
            "a wait is 0 to 86400 seconds",
            "give a number of seconds, such as --wait 10",
        ));
    }
    Ok(())
}

fn write(
    args: &Args,
    planet: &Planet,
    renderer: &mut dyn Renderer,
    (view, settings): (&View, &Settings),
    frame: &Frame,
) -> Result<(), ToolError> {
    let pixels = frame.colour.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    write_png(&args.out, &RgbImage { width: frame.width as usize, height: frame.height as usize, pixels })?;
    if let Some(path) = &args.mask {
        publish(path, |out| write_grey_png(out, [frame.width, frame.height], &frame.lit))?;
    }
    if let Some(path) = &args.mesh {
        let triangles = renderer.mesh(view, settings.scheme).map_err(of_render(&args.file))?;
        let bytes = glb(planet, &view.camera, triangles)?;
        publish(path, |out| std::io::Write::write_all(out, &bytes))?;
    }
    Ok(())
}

/// Says on standard error what the frame lacks.
fn judged(frame: &Frame) -> Outcome {
    let stats = &frame.stats;
    if stats.tiles_missing > 0 {
        say(&format!(
            "reliefd: {} tiles are missing; coarser ones stand in (a longer --wait, or fewer pixels)",
            stats.tiles_missing
        ));
    }
    if stats.overflow {
        say("reliefd: the mesh has holes: too many triangles; give a larger --pixel-error");
    }
    if stats.tiles_missing > 0 || stats.overflow { Outcome::Found } else { Outcome::Good }
}
