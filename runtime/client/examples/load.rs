//! Many viewers of one daemon, each on a path of its own, and what they got: `just bench-serve`
//! starts it. Nothing is decoded, so that the daemon is measured.
//!
//! Prints one JSON object: seconds, and of each viewer its pictures, bytes, the most tiles that its
//! pictures told of, and the milliseconds from sending a view to the last payload of its first picture.

use std::error::Error;
use std::f64::consts::TAU;
use std::process::ExitCode;
use std::thread;
use std::time::{Duration, Instant};

use clap::Parser;
use relief_client::{AttachError, Attached, Event, Options};
use relief_protocol::to_server::{Frame, Streams};
use relief_protocol::view::View;

/// Attaches viewers to a daemon for a while and measures what they get.
#[derive(Parser)]
struct Args {
    /// HOST:PORT of a daemon, or the path of its Unix socket
    address: String,
    /// Viewers
    #[arg(long, default_value_t = 1)]
    viewers: u32,
    /// Width of the pictures
    #[arg(long, default_value_t = 320)]
    width: u32,
    /// Their height
    #[arg(long, default_value_t = 180)]
    height: u32,
    /// Seconds that are measured
    #[arg(long, default_value_t = 8.0)]
    seconds: f64,
    /// Seconds before, in which tiles come in
    #[arg(long, default_value_t = 4.0)]
    warm_s: f64,
    /// All fly the same path, so that all want the same tiles
    #[arg(long)]
    same_path: bool,
}

#[derive(Default)]
struct Found {
    pictures: u64,
    bytes: u64,
    tiles: u64,
    latency_ms: Vec<f64>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let paths = (0..args.viewers).map(|k| if args.same_path { 0 } else { k });
    let all: Result<Vec<Found>, AttachError> = thread::scope(|scope| {
        let args = &args;
        let flights: Vec<_> = paths.map(|path| scope.spawn(move || fly(args, path))).collect();
        // A panic there is a defect of this program.
        flights
            .into_iter()
            .map(|flight| flight.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    let viewers: Vec<serde_json::Value> = match all {
        Ok(all) => all.iter().map(Found::as_json).collect(),
        Err(error) => {
            eprintln!("load: {error}");
            if let Some(source) = error.source() {
                eprintln!("  because: {source}");
            }
            return ExitCode::from(2);
        }
    };
    println!("{}", serde_json::json!({ "seconds": args.seconds, "viewers": viewers }));
    ExitCode::SUCCESS
}

impl Found {
    fn as_json(&self) -> serde_json::Value {
        let Self { pictures, bytes, tiles, latency_ms } = self;
        serde_json::json!({ "pictures": pictures, "bytes": bytes, "tiles": tiles, "latency_ms": latency_ms })
    }
}

/// Around a circle, view by view; the next goes out when the first picture of the last has come.
fn fly(args: &Args, path: u32) -> Result<Found, AttachError> {
    let mut daemon = Attached::to(&args.address, &Options { viewer: format!("load {path}"), ..Options::default() })?;
    let planet =
        daemon.welcome().planets.first().map(|planet| (planet.name.clone(), planet.bounds)).unwrap_or_default();
    let (name, bounds) = planet;
    daemon.camera("main", &name, Streams { frame: Some(Frame::default()), ..Streams::default() })?;
    let (mut found, mut step) = (Found::default(), 0);
    let measured = Instant::now() + Duration::from_secs_f64(args.warm_s);
    let end = measured + Duration::from_secs_f64(args.seconds);
    while Instant::now() < end {
        let sent = Instant::now();
        let number = daemon.view("main", view(args, bounds, path, step))?;
        step += 1;
        loop {
            let Event::Payload(payload) = daemon.next_event()? else { continue };
            let header = payload.header();
            let is_measured = sent >= measured && Instant::now() < end;
            if is_measured {
                found.pictures += u64::from(header.part == 0);
                found.bytes += payload.with(<[u8]>::len).unwrap_or_default() as u64;
                found.tiles = found.tiles.max(header.stats.tiles_resident);
            }
            if header.view == number && header.part + 1 == header.parts {
                if is_measured {
                    found.latency_ms.push((sent.elapsed().as_secs_f64() * 1e5).round() / 1e2);
                }
                break;
            }
        }
    }
    Ok(found)
}

/// A circle about one of many places, looked at from the south, 60 views around.
fn view(args: &Args, [west, south, east, north]: [f64; 4], path: u32, step: u32) -> View {
    // Golden sections spread places evenly, however many there are.
    let along = |first: f64, last: f64, share: f64| {
        first + (last - first) * (0.2 + 0.6 * (share + f64::from(path) * 0.618).fract())
    };
    let turn = f64::from(step % 60) / 60.0 * TAU;
    let side = (east - west).min(north - south);
    let (x, y) =
        (along(west, east, 0.5) + 0.02 * side * turn.cos(), along(south, north, 0.3) + 0.02 * side * turn.sin());
    let height_m = if east - west > 359.0 { 400e3 } else { side };
    View { pose: vec![x, y, height_m, 0.0, -50.0, 0.0], ..View::down([x, y, height_m], [args.width, args.height]) }
}
