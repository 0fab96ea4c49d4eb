//! A viewer: attaches to a `reliefd serve`, flies once around a place and says how that went.
//!
//! The example of a host program: it sends a view, takes the pictures of that view as they come,
//! coarse ones first, and sends the next. Run it beside the daemon:
//!
//! ```text
//! cargo run --release -p relief-client --example fly -- 127.0.0.1:7878 --out last.jpg --mesh last.ply
//! cargo run --release -p relief-client --example fly -- /run/reliefd.sock --pictures 500
//! ```

mod flight;
mod orbit;
mod ply;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Duration;

use clap::Parser;
use relief_client::{Attached, Options, Payload};
use relief_protocol::payload::Stream;
use relief_protocol::to_server::{Frame, FrameFormat, Mesh, Streams};

use flight::Flight;
use orbit::Orbit;

/// Flies around a place of a daemon's planet and measures frames a second and latency.
#[derive(Parser)]
struct Args {
    /// HOST:PORT or ws://HOST:PORT of a daemon, or the path of its Unix socket
    address: String,
    /// The planet; the daemon's first if left out
    #[arg(long, value_name = "NAME")]
    planet: Option<String>,
    /// Longitude and latitude (a plane: X and Y) to fly around
    #[arg(long, value_name = "X,Y", value_parser = pair::<f64>, allow_hyphen_values = true)]
    place: Option<[f64; 2]>,
    /// Height above the ellipsoid or the plane, metres
    #[arg(long, value_name = "M")]
    height: Option<f64>,
    /// Views on the way around
    #[arg(long, value_name = "N", default_value_t = 60)]
    views: u32,
    /// Width and height, pixels
    #[arg(long, value_name = "WxH", value_parser = pair::<u32>, default_value = "1280x720")]
    size: [u32; 2],
    /// Wait for the complete picture of each view, not only for its first
    #[arg(long)]
    patient: bool,
    /// The daemon's token
    #[arg(long)]
    token: Option<String>,
    /// The last picture is written there: .jpg or .png
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The last picture's mesh is written there as PLY: east, north and up of the camera, metres
    #[arg(long, value_name = "FILE.ply")]
    mesh: Option<PathBuf>,
    /// Seconds to wait for the daemon
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    timeout: f64,
}

/// Two numbers with a comma or an x between them.
fn pair<T: FromStr>(text: &str) -> Result<[T; 2], String> {
    let numbers: Result<Vec<T>, _> = text.split([',', 'x']).map(|number| number.trim().parse()).collect();
    let pair = numbers.ok().and_then(|numbers| <[T; 2]>::try_from(numbers).ok());
    pair.ok_or_else(|| format!("{text:?} is not two numbers"))
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("fly: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let timeout = Duration::try_from_secs_f64(args.timeout)?;
    let options = Options { viewer: "fly".into(), token: args.token.clone(), timeout, ..Options::default() };
    let mut daemon = Attached::to(&args.address, &options)?;
    let planets = &daemon.welcome().planets;
    let planet = match &args.planet {
        Some(name) => planets.iter().find(|planet| planet.name == *name),
        None => planets.first(),
    };
    let names = || planets.iter().map(|planet| planet.name.as_str()).collect::<Vec<_>>().join(", ");
    let planet = planet.ok_or_else(|| format!("no such planet; this daemon serves: {}", names()))?;
    let (name, backend) = (planet.name.clone(), planet.backend.clone());
    let orbit = Orbit::new(planet, args.place, args.height, args.size);

    let is_png = args.out.as_ref().is_some_and(|path| path.extension().is_some_and(|kind| kind == "png"));
    let format = if is_png { FrameFormat::Png } else { FrameFormat::Jpeg };
    let frame = Some(Frame { format, ..Frame::default() });
    daemon.camera("fly", &name, Streams { frame, ..Streams::default() })?;
    let mut flight = Flight::new(&mut daemon);
    for step in 0..args.views {
        flight.go(orbit.view(step, args.views), args.patient, |_| Ok(()))?;
    }
    println!("{name} on {backend}\n{}", flight.figures());

    // Once more, in full, with the mesh where it is wanted.
    let mesh = args.mesh.as_ref().map(|_| Mesh {});
    flight.daemon().camera("fly", &name, Streams { frame, mesh, ..Streams::default() })?;
    flight.go(orbit.view(0, args.views), true, |payload| save(args, payload))?;
    Ok(())
}

/// Writes a payload where it is wanted; a later one replaces it.
fn save(args: &Args, payload: &Payload) -> Result<(), Box<dyn Error>> {
    match (payload.header().stream, &args.out, &args.mesh) {
        (Stream::Frame, Some(path), _) => std::fs::write(path, payload.copied()?)?,
        (Stream::Mesh, _, Some(path)) => {
            if let Some((vertices, indices)) = payload.mesh()? {
                ply::write(path, &vertices, &indices)?;
            }
        }
        _ => {}
    }
    Ok(())
}
