//! The headline of paper 000 on a file of one's own: how many triangles a view needs by the scheme
//! `paper`, by the scheme `leb`, and by a uniform mesh of level-0 cells over the same ground.
//!
//! `cargo run --release -p relief-runtime --example paper_headline -- FILE [HEIGHT_KM]`

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_runtime::planet::Planet;
use relief_runtime::residency::{Capacity, Ram, Resident};
use relief_runtime::view::{Camera, Sun, View};
use relief_shaders::pages::Pages;
use relief_shaders::planet::View as Uniform;
use relief_shaders::{leb, paper};

/// Full HD, as the paper has it.
const SIZE: [u32; 2] = [1920, 1080];

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let file = args.next().ok_or("usage: paper_headline FILE [HEIGHT_KM]")?;
    let height_m = args.next().map_or(Ok(400.0), |km| km.parse::<f64>())? * 1e3;
    let planet = Planet::open(Path::new(&file))?;
    let capacity = Capacity::within(3 << 30, 2 << 30)?;
    let mut resident = Resident::new(Arc::clone(&planet), capacity, Ram::new(capacity))?;
    println!("view | n_px | uniform | paper: relief + fillers, tested, passes, ms | leb: triangles, ms");
    for (name, pitch_deg, fov_deg) in [("down", -90.0, 60.0), ("down, x 4", -90.0, 16.4), ("ahead", -35.0, 60.0)] {
        for n_px in [1.0, 2.0] {
            let camera = Camera::over_globe(96.0, 24.0, height_m)?.looking(20.0, pitch_deg, 0.0).with_fov(fov_deg);
            let view = View { pixel_error: n_px, ..View::new(camera, SIZE, Sun::over(96.0, 24.0)?) };
            let view = view.uniform(&planet)?;
            let (drawn, paper_ms) = complete(&mut resident, &view, paper::tessellate);
            let (mesh, leb_ms) = complete(&mut resident, &view, leb::tessellate);
            let stats = drawn.stats;
            println!(
                "{name} | {n_px} | {} | {} + {}, {}, {}, {paper_ms:.1} | {}, {leb_ms:.1}",
                uniform(&drawn, planet.grid().m),
                stats.relief,
                stats.fillers,
                stats.tested,
                stats.passes,
                mesh.triangles.len(),
            );
        }
    }
    Ok(())
}

/// Tessellates until no page lacks; then once more, timed.
fn complete<T>(
    resident: &mut Resident<Ram>,
    view: &Uniform,
    tessellate: impl Fn(&Pages<'_>, &Uniform, &leb::Params) -> T,
) -> (T, f64) {
    loop {
        let pages = resident.pages();
        let params = leb::Params::new(pages.planet, view, 1 << 24, 1 << 24);
        let clock = Instant::now();
        let result = tessellate(&pages, view, &params);
        let ms = clock.elapsed().as_secs_f64() * 1e3;
        if resident.ask_seen() == 0 {
            return (result, ms);
        }
        if resident.update(Duration::from_secs(30)).loaded == 0 {
            eprintln!("pages are missing");
            return (result, ms);
        }
    }
}

/// Halves of level-0 cells under the relief triangles: fillers have no area on the map.
fn uniform(drawn: &paper::Drawn, m: u32) -> u64 {
    let halves = |t: &leb::ReliefTriangle| {
        let side = |k: usize| {
            [t[k].s.wrapping_sub(t[0].s), t[k].t.wrapping_sub(t[0].t)].map(|d| i64::from(d as i32) >> (31 - m))
        };
        let (a, b) = (side(1), side(2));
        (a[0] * b[1] - a[1] * b[0]).unsigned_abs()
    };
    drawn.triangles.iter().map(halves).sum()
}
