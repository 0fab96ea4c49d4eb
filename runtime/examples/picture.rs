//! Draws a view of a file: `picture FILE OUT.ppm LON LAT HEIGHT HEADING PITCH FOV W H SUNLON SUNLAT [overlay]`.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a tool for the developer's eye")]
use relief_runtime::cpu::Cpu;
use relief_runtime::frame::{Overlay, Renderer, Scheme, Settings};
use relief_runtime::planet::Planet;
use relief_runtime::view::{Camera, Sun, View};
use std::path::Path;
use std::time::Duration;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let n = |k: usize| args[k].parse::<f64>().unwrap();
    let planet = Planet::open(Path::new(&args[1])).unwrap();
    let scheme = std::env::var("LEVEL").map_or(Scheme::Leb, |v| Scheme::Uniform { level: v.parse().unwrap() });
    let (camera, sun) = if planet.grid().plane {
        (Camera::over_plane(&planet, n(3), n(4), n(5)).unwrap(), Sun::at(n(11), n(12)).unwrap())
    } else {
        (Camera::over_globe(n(3), n(4), n(5)).unwrap(), Sun::over(n(11), n(12)).unwrap())
    };
    let view = View::new(camera.looking(n(6), n(7), 0.0).with_fov(n(8)), [n(9) as u32, n(10) as u32], sun);
    let overlay = match args.get(13).map(String::as_str) {
        Some("wire") => Overlay::Wireframe,
        Some("lod") => Overlay::Detail,
        _ => Overlay::None,
    };
    let settings = Settings { scheme, overlay, places: false };
    let mut cpu = Cpu::new(planet, 512 << 20).unwrap();
    let frame = cpu.render_until_complete(&view, &settings, Duration::from_secs(100)).unwrap();
    eprintln!("{:?}", frame.stats);
    let mut out = format!("P6 {} {} 255\n", frame.width, frame.height).into_bytes();
    out.extend(frame.colour.iter().flat_map(|c| [c[0], c[1], c[2]]));
    std::fs::write(&args[2], out).unwrap();
}
