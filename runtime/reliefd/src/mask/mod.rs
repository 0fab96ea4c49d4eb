//! `reliefd mask`: how much of the sun every node sees.

pub mod asked;
mod cast;
pub mod parts;
pub mod raster;
pub mod sweep;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use chrono::{DateTime, Utc};
use relief_front::error::ToolError;
use relief_front::publish::publish;
use relief_front::stdout::print;
use relief_front::window::{Rectangle, Samples};
use relief_runtime::geotiff::sidecar;
use relief_runtime::planet::Planet;
use relief_runtime::shadow::WindowCounts;

use self::asked::{MaskArgs, without_sun};
use self::cast::Caster;
use self::raster::write_tif;
use crate::Outcome;
use crate::backend::{Backend, BackendChoice};
use crate::errors::open;
use crate::light::Light;
use crate::output::{check_name, extension, write_grey_png};
use crate::typed::{TimesArg, plain};

/// Shadows: how much of the sun every node of a level sees
#[derive(Debug, clap::Args)]
#[command(
    long_about = "Shadows: how much of the sun every node of a level sees.\n\n\
        Values are 0 in shadow and 255 in the light, between on a soft edge. A GeoTIFF lies exactly where \
        `relief-bake export` puts the same level and window: the pixels' centres are the nodes. A CRS without \
        an EPSG code goes into MASK.tif.aux.xml, which GDAL reads. The rays are straight, above the curved body. Outputs that exist are replaced.",
    after_long_help = "With --times the outputs are MASK_TIME.tif, TIME as 20260621T120000Z.\n\n\
        Examples:\n  reliefd mask earth.relief --time 2026-06-21T03:30:00Z --window 80,25,95,35 -o himalaya.tif\n  \
        reliefd mask moon.relief --sun 90,-1.5 --level 2 --soft -o moon.png\n  \
        reliefd mask map.relief --sun 135,10 -o map.tif\n  \
        reliefd mask earth.relief --times 2026-06-21T00:00:00Z,2026-06-21T06:00:00Z,30min --level 3 -o day.tif"
)]
pub struct Args {
    /// The .relief file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    asked: MaskArgs,
    /// A mask for each time from FROM to TO (RFC 3339), STEP as 30s, 15min, 1h or 1d
    #[arg(long, value_name = "FROM,TO,STEP", conflicts_with_all = ["sun", "time"])]
    times: Option<TimesArg>,
    /// Where the kernels run
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// Print one JSON object a mask: rays, seconds, fetches per ray
    #[arg(long)]
    stats: bool,
    /// What to write: .tif for a GeoTIFF, .png for a picture
    #[arg(short, long, value_name = "MASK.tif|png")]
    output: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    check_name("--output", &args.output, &["tif", "tiff", "png"])?;
    let planet = open(&args.file)?;
    let lights = lights(args, &planet)?;
    let asked = &args.asked;
    let (samples, rectangle) = asked.nodes(&planet)?;
    let backend = Backend::find(args.backend)?;
    // What a sweep over a plane cannot do.
    let single = asked.soft || asked.air > 0.0;
    let mut caster = Caster::new(Arc::clone(&planet), &args.file, asked.level, &backend, single)?;
    for light in &lights {
        let began = Instant::now();
        let (mask, counts) = caster.mask(&light.sun, [asked.radius_deg(), f64::from(asked.air)], rectangle)?;
        let cast = began.elapsed();
        let path = match (&args.times, light.time) {
            (Some(_), Some(time)) => stamped(&args.output, time),
            _ => args.output.clone(),
        };
        write(&path, &planet, asked.level, light, (&samples, rectangle), &mask)?;
        let lit = mask.iter().map(|&v| u64::from(v)).sum::<u64>() as f64 / 255.0 / mask.len() as f64;
        print(&match args.stats {
            true => stats(&path, &backend, rectangle, lit, cast, counts),
            false => said(&path, rectangle, asked.level, lit),
        })?;
    }
    Ok(Outcome::Good)
}

fn said(path: &Path, Rectangle { columns, rows, .. }: Rectangle, level: u32, lit: f64) -> String {
    format!("{}: {columns} x {rows} nodes of level {level}, {:.2} % lit\n", path.display(), lit * 100.0)
}

fn stats(
    path: &Path,
    backend: &Backend,
    Rectangle { columns, rows, .. }: Rectangle,
    lit: f64,
    cast: Duration,
    counts: Option<WindowCounts>,
) -> String {
    let rays = u64::from(columns) * u64::from(rows);
    // A sweep reads strips, not rays.
    let fetches = counts.map(|counts| (counts.heights + counts.extremes) as f64 / rays as f64);
    let object = serde_json::json!({
        "output": path,
        "backend": backend.name(),
        "columns": columns,
        "rows": rows,
        "lit": lit,
        "rays": rays,
        "seconds": cast.as_secs_f64(),
        "rays_per_second": rays as f64 / cast.as_secs_f64(),
        "fetches_per_ray": fetches,
    });
    format!("{object}\n")
}

fn lights(args: &Args, planet: &Planet) -> Result<Vec<Light>, ToolError> {
    if let Some(TimesArg(times)) = &args.times {
        return times.iter().map(|&time| Light::at(planet, time)).collect();
    }
    args.asked.sun.light(planet)?.map(|light| vec![light]).ok_or_else(|| without_sun(planet, true))
}

/// MASK.tif as MASK_20260621T120000Z.tif.
fn stamped(path: &Path, time: DateTime<Utc>) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let stamp: String = plain(time).chars().filter(|c| !matches!(c, '-' | ':')).collect();
    path.with_file_name(format!("{stem}_{stamp}.{}", extension(path)))
}

fn write(
    path: &Path,
    planet: &Planet,
    level: u32,
    light: &Light,
    nodes: (&Samples, Rectangle),
    mask: &[u8],
) -> Result<(), ToolError> {
    if extension(path) == "png" {
        return publish(path, |out| write_grey_png(out, [nodes.1.columns, nodes.1.rows], mask));
    }
    beside(path, sidecar(planet.relief().body()))?;
    publish(path, |out| write_tif(out, planet, level, light, nodes, mask))
}

/// Writes GDAL's file beside a raster, or removes one that belonged to an earlier raster.
fn beside(path: &Path, text: Option<String>) -> Result<(), ToolError> {
    let mut name = path.as_os_str().to_owned();
    name.push(".aux.xml");
    let path = PathBuf::from(name);
    match text {
        Some(text) => publish(&path, |out| out.write_all(text.as_bytes())),
        None => match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(ToolError::Io {
                action: "cannot remove",
                path,
                error,
                remedy: "remove it: it belongs to an earlier raster of that name".into(),
            }),
            _ => Ok(()),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_carry_their_time() {
        let time = |text: &str| crate::typed::time(text).unwrap_or_default();
        let name = |path, at| stamped(Path::new(path), time(at)).display().to_string();
        assert_eq!(name("out/day.tif", "2026-06-21T12:00:00Z"), "out/day_20260621T120000Z.tif");
        assert_eq!(name("a.b.PNG", "2026-06-21T12:00:00.5+01:00"), "a.b_20260621T110000.500Z.png");
    }
}
