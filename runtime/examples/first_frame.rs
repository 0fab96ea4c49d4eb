//! From a file to its first frame, and the passes of a frame once all is there: milliseconds as
//! JSON.
//!
//! `first_frame FILE [cpu|gpu] [WIDTHxHEIGHT] [HEIGHT_M]`

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use relief_runtime::cpu::Cpu;
use relief_runtime::frame::{Renderer, Settings};
use relief_runtime::gpu::{Device, Gpu};
use relief_runtime::planet::Planet;
use relief_runtime::view::{Camera, Sun, View};

const ATLAS_BYTES: u64 = 512 << 20;
/// Frames over which passes are averaged.
const FRAMES: u32 = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let file = args.first().ok_or("first_frame FILE [cpu|gpu] [WIDTHxHEIGHT] [HEIGHT_M]")?;
    let size = args.get(2).map_or("1920x1080", String::as_str).split_once('x').ok_or("WIDTHxHEIGHT")?;
    let size = [size.0.parse()?, size.1.parse()?];
    let height_m: f64 = args.get(3).map_or(Ok(400_000.0), |m| m.parse())?;
    let mut laps = Vec::new();
    let mut clock = Instant::now();
    let mut lap = |name: &'static str| {
        laps.push((name, clock.elapsed().as_secs_f64() * 1e3));
        clock = Instant::now();
    };
    let planet = Planet::open(Path::new(file))?;
    lap("open");
    let (adapter, mut renderer): (String, Box<dyn Renderer>) = match args.get(1).map(String::as_str) {
        Some("cpu") => ("none".into(), Box::new(Cpu::new(planet.clone(), ATLAS_BYTES)?)),
        _ => {
            let device = Device::headless(relief_runtime::gpu::AdapterChoice::Fastest)?;
            lap("adapter");
            (device.info().name, Box::new(Gpu::new(&device, planet.clone(), ATLAS_BYTES)?))
        }
    };
    lap("backend");
    let (camera, sun) = if planet.grid().plane {
        let relief_formats::body::Body::Plane { x0, y0, dx, dy, .. } = *planet.relief().body() else { return Ok(()) };
        let middle = f64::from(planet.grid().width(0)) / 2.0;
        (Camera::over_plane(&planet, x0 + dx * middle, y0 + dy * middle, height_m)?, Sun::at(315.0, 30.0)?)
    } else {
        (Camera::over_globe(86.9, 28.0, height_m)?, Sun::over(40.0, 10.0)?)
    };
    let view = View::new(camera, size, sun);
    renderer.render(&view, &Settings::default())?;
    lap("first_frame");
    let frame = renderer.render_until_complete(&view, &Settings::default(), Duration::from_secs(600))?;
    lap("complete_frame");
    let mut pass_ms: Vec<(&str, f64)> = Vec::new();
    for _ in 0..FRAMES {
        let stats = renderer.render(&view, &Settings::default())?.stats;
        pass_ms.resize(stats.pass_ms.len(), ("", 0.0));
        for (sum, (name, ms)) in pass_ms.iter_mut().zip(&stats.pass_ms) {
            *sum = (name, sum.1 + ms / f64::from(FRAMES));
        }
    }
    let list = |values: &[(&str, f64)]| {
        values.iter().map(|(name, ms)| format!("\"{name}\": {ms:.3}")).collect::<Vec<_>>().join(", ")
    };
    println!(
        "{{\"adapter\": \"{adapter}\", \"triangles\": {}, \"tiles\": {}, \"ms\": {{{}}}, \"pass_ms\": {{{}}}}}",
        frame.stats.triangles,
        frame.stats.tiles_resident,
        list(&laps),
        list(&pass_ms)
    );
    Ok(())
}
