//! `GET /v1/planets/{name}/shadow`: what `reliefd mask` writes. Planes are swept beside the engine; other
//! rays are cast by the planet's engine in parts, so that pictures go on meanwhile.

use std::io::Cursor;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::State;
use axum::http::{HeaderName, header};
use axum::response::{IntoResponse as _, Response};
use relief_front::window::{Rectangle, Samples};
use relief_protocol::error::{Code, Fault};
use relief_runtime::frame::RenderError;
use relief_runtime::geotiff::sidecar;
use relief_runtime::planet::Planet;
use relief_runtime::shadow::{ShadowWindow, sun_of};

use crate::light::Light;
use crate::mask::asked::{MaskArgs, without_sun};
use crate::mask::parts::{Part, Whole, parts};
use crate::mask::raster::write_tif;
use crate::mask::sweep::Sweep;
use crate::output::write_grey_png;
use crate::serve::ask::{of_draw, of_tool};
use crate::serve::http::at::At;
use crate::serve::http::off_thread::{Asker, off_thread};
use crate::serve::http::refused::Refused;
use crate::serve::http::words::Words;
use crate::serve::hub::{Hub, Served};

/// Most nodes of a mask.
const MOST_NODES: u64 = 16 << 20;
/// A plane's level is swept whole for a window of at least this part of its nodes: a sweep is some
/// fifty times as fast as rays, but reads them all.
const SWEPT_PART: u64 = 16;
/// Nodes along a side of what is cast in one turn at the engine: no longer than a picture takes.
const PART: u32 = 256;
/// Time for tiles in one turn at the engine.
const TURN: Duration = Duration::from_millis(50);
/// Longest time in which no tile comes.
const PATIENCE: Duration = Duration::from_secs(20);

/// A mask that is asked for.
#[derive(Debug, clap::Args)]
pub struct ShadowArgs {
    #[command(flatten)]
    mask: MaskArgs,
    /// How it is packed
    #[arg(long, value_enum, default_value = "png")]
    format: MaskFormat,
}

/// How masks are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum MaskFormat {
    /// 8-bit grey
    Png,
    /// GeoTIFF
    Tif,
    /// What GDAL wants beside the GeoTIFF (.aux.xml), where its CRS has no EPSG code
    Aux,
}

/// How much of the sun every node of a level sees: 0 shadow, 255 light
///
/// At most 16 777 216 nodes. Headers: X-Relief-Geotransform (GDAL's, of the nodes as pixels'
/// centres), X-Relief-Sun, X-Relief-Lit (the share that is lit).
#[utoipa::path(
    get,
    path = "/v1/planets/{name}/shadow",
    params(At, Words<ShadowArgs>),
    responses(
        (status = 200, description = "The mask", content(
            (Vec<u8> = "image/png"),
            (Vec<u8> = "image/tiff"),
            (String = "application/xml"),
        )),
        Refused,
    )
)]
pub async fn shadow(
    State(hub): State<Arc<Hub>>,
    At(served): At,
    Words(args): Words<ShadowArgs>,
) -> Result<Response, Refused> {
    let planet = served.planet();
    if args.format == MaskFormat::Aux {
        return beside(&planet);
    }
    let (samples, rectangle, light) = checked(&args.mask, &planet)?;
    let lit = cast(&served, hub.client(), &planet, &args.mask, rectangle, &light).await?;
    let share = lit.iter().map(|&lit| u64::from(lit)).sum::<u64>() as f64 / 255.0 / lit.len().max(1) as f64;
    let transform = samples.geo_transform(rectangle).map(|number| number.to_string()).join(",");
    let headers = [
        (HeaderName::from_static("x-relief-geotransform"), transform),
        (HeaderName::from_static("x-relief-sun"), light.angles()),
        (HeaderName::from_static("x-relief-lit"), format!("{share:.6}")),
    ];
    let kind = if args.format == MaskFormat::Tif { "image/tiff" } else { "image/png" };
    let bytes = off_thread(move |_| {
        let mut out = Cursor::new(Vec::new());
        let packed = match args.format {
            MaskFormat::Tif => write_tif(&mut out, &planet, args.mask.level, &light, (&samples, rectangle), &lit),
            _ => write_grey_png(&mut out, [rectangle.columns, rectangle.rows], &lit),
        };
        packed.map(|()| out.into_inner()).map_err(|error| {
            Fault::new(Code::Internal, error.to_string(), "a mask can be packed", "tell whoever runs the daemon")
        })
    })
    .await?;
    Ok(([(header::CONTENT_TYPE, kind)], headers, bytes).into_response())
}

fn beside(planet: &Planet) -> Result<Response, Refused> {
    let text = sidecar(planet.relief().body()).ok_or_else(|| {
        Fault::new(
            Code::Unknown,
            "format=aux of a planet whose GeoTIFF says all",
            "only a CRS without an EPSG code needs a file beside its GeoTIFF",
            "ask for format=tif alone",
        )
    })?;
    Ok(([(header::CONTENT_TYPE, "application/xml")], text).into_response())
}

fn checked(args: &MaskArgs, planet: &Planet) -> Result<(Samples, Rectangle, Light), Fault> {
    let refused = |error| of_tool(Code::BadView, &error);
    let light = args.sun.light(planet).map_err(refused)?.ok_or_else(|| refused(without_sun(planet, false)))?;
    let (samples, rectangle) = args.nodes(planet).map_err(refused)?;
    let Rectangle { columns, rows, .. } = rectangle;
    if u64::from(columns) * u64::from(rows) > MOST_NODES {
        return Err(Fault::new(
            Code::TooLarge,
            format!("a mask of {columns} x {rows} nodes of level {}", args.level),
            format!("a mask has at most {MOST_NODES} nodes"),
            "ask for a smaller window or a coarser level, or run `reliefd mask`",
        ));
    }
    Ok((samples, rectangle, light))
}

async fn cast(
    served: &Arc<Served>,
    client: u64,
    planet: &Arc<Planet>,
    args: &MaskArgs,
    rectangle: Rectangle,
    light: &Light,
) -> Result<Vec<u8>, Fault> {
    let sun = sun_of(&light.sun, args.radius_deg());
    if swept(args, planet, rectangle) {
        let (planet, level) = (Arc::clone(planet), args.level);
        return off_thread(move |asker| sweep(&planet, level, [sun[0], sun[1], sun[2]], rectangle, asker)).await;
    }
    let like = ShadowWindow { sun, air: args.air, level: args.level, ..ShadowWindow::default() };
    let mut whole = Whole::new(rectangle);
    for part in parts(rectangle, planet.grid(), like, PART) {
        let mut wanted = Vec::new();
        let (mut least, mut deadline) = (usize::MAX, Instant::now() + PATIENCE);
        let lit = loop {
            match turn(served, client, planet, part, wanted).await? {
                Turn::Cast(lit) => break lit,
                Turn::Lacks(pages, left) => {
                    if left < least {
                        (least, deadline) = (left, Instant::now() + PATIENCE);
                    } else if Instant::now() >= deadline {
                        return Err(without_tiles(left, args.level));
                    }
                    wanted = pages;
                }
            }
        };
        whole.put(&part, &lit);
    }
    Ok(whole.into_lit())
}

/// Whether a mask is made of a whole plane at once: hard edges, no air, and not too little of it.
fn swept(args: &MaskArgs, planet: &Planet, rectangle: Rectangle) -> bool {
    let grid = planet.grid();
    if !grid.plane || args.soft || args.air > 0.0 || args.level > grid.root_level() {
        return false;
    }
    let level = u64::from(grid.width(args.level)) * u64::from(grid.height(args.level));
    level <= MOST_NODES && u64::from(rectangle.columns) * u64::from(rectangle.rows) * SWEPT_PART >= level
}

fn sweep(
    planet: &Arc<Planet>,
    level: u32,
    towards: [f32; 3],
    rectangle: Rectangle,
    asker: &Asker,
) -> Result<Vec<u8>, Fault> {
    let damaged = |error| of_draw(RenderError::File(error));
    planet.relief().check_whole().map_err(damaged)?;
    let sweep = Sweep::new(Arc::clone(planet), level).map_err(damaged)?;
    asker.waits()?;
    Ok(sweep.mask(towards, rectangle))
}

/// What a turn at the engine brought.
enum Turn {
    /// The part's nodes.
    Cast(Vec<u8>),
    /// Pages that its rays need, and how many of them are still to come.
    Lacks(Vec<u32>, usize),
}

/// Loads what the turn before lacked; once it is all there, casts.
async fn turn(
    served: &Arc<Served>,
    client: u64,
    planet: &Arc<Planet>,
    part: Part,
    wanted: Vec<u32>,
) -> Result<Turn, Fault> {
    let (of, planet) = (Arc::clone(served), Arc::clone(planet));
    let done = served.engine.run(client, move |drawer| {
        // On the engine's thread: this is the planet that it draws.
        if !Arc::ptr_eq(&of.planet(), &planet) {
            return Err(Fault::new(Code::Busy, "the planet's file was replaced", "a mask is of one file", "ask again"));
        }
        if !wanted.is_empty() {
            drawer.ask(&wanted);
            drawer.update(TURN);
            let left = drawer.still_lacks(&wanted);
            if left > 0 {
                return Ok(Turn::Lacks(wanted, left));
            }
        }
        let mask = drawer.mask(&part.window).map_err(|error| of_draw(error.into()))?;
        Ok(if mask.lacking == 0 { Turn::Cast(mask.lit) } else { Turn::Lacks(drawer.lacked(), mask.lacking) })
    });
    done.await?
}

fn without_tiles(lacking: usize, level: u32) -> Fault {
    Fault::new(
        Code::Damaged,
        format!("{lacking} tiles that rays need at level {level} are not at hand"),
        "the tiles on the way of a part's rays can be read and fit the memory for tiles",
        "ask for a coarser level; whoever runs the daemon gives it more memory, or checks the file with \
         `relief-bake validate`",
    )
}
