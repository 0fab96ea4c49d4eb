//! Speed and fetches of the shadow kernels on a planar file: `shadow_bench FILE.relief [REPEAT]`.
//!
//! A file of a map smaller than its square may be mirrored: `--mirror N` fills the square with the
//! N x N nodes of its south-west corner, mirrored.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use relief_formats::body::Body;
use relief_formats::file::Relief;
use relief_formats::tiles::Tiles;
use relief_shaders::planet::Planet;
use relief_shaders::shadow::dense::Dense;
use relief_shaders::shadow::sweep::{PlaneNodes, sweep_mask};
use relief_shaders::shadow::{Counts, shadow_exact};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: shadow_bench FILE.relief [--mirror N]")?;
    let mirror = match arguments.next().as_deref() {
        Some("--mirror") => Some(arguments.next().ok_or("--mirror N")?.parse::<usize>()?),
        _ => None,
    };
    let relief = Relief::open(Path::new(&path))?;
    let tiles = Tiles::new(&relief, 64 << 20);
    let grid = relief.grid();
    let Body::Plane { dx, dy, .. } = *relief.body() else { return Err("not a plane".into()) };
    let unit = f64::from(31 - grid.m).exp2();
    let step_m = relief.step_m() as f32;
    let mut planet = Planet {
        m: grid.m,
        plane: 1,
        root_level: grid.root_level(),
        step_m,
        unit_x_m: (dx / unit) as f32,
        unit_y_m: (dy / unit) as f32,
        ..Planet::default()
    };
    let mut dense = Dense::from_tiles(&planet, &tiles, 0)?;
    let (columns, rows) = (dense.columns(), dense.rows());
    if let Some(n) = mirror {
        let fold = |v: usize| if v / n % 2 == 0 { v % n } else { n - 1 - v % n };
        let nodes = (0..=rows)
            .flat_map(|j| (0..=columns).map(move |i| (fold(i.min(columns - 1)), fold(j.min(rows - 1)))))
            .map(|(i, j)| dense.row_m(j)[i])
            .collect();
        dense = Dense::from_nodes(&planet, 0, nodes);
    }
    planet.max_m = dense.nodes_m().iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b));
    let samples: Vec<i16> = dense.nodes_m().iter().map(|&h| (h / step_m) as i16).collect();
    let nodes = PlaneNodes { samples: &samples, unit_m: step_m, columns, rows, spacing_m: [dx, dy] };
    let rays = (columns * rows) as f64;
    println!("{columns} x {rows} nodes, {} threads, median of 5, azimuth 135", rayon::current_num_threads());
    println!("kernel  elevation   Mray/s  a CPU s  heights  extremes   steps   dark %");
    for elevation_deg in [2.0f64, 5.0, 10.0, 20.0] {
        let ((sa, ca), (se, ce)) = (135f64.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
        let sun = [ce * sa, ce * ca, se].map(|v| v as f32);
        let seconds = timed(9, || {
            std::hint::black_box(sweep_mask::<false, i16>(&nodes, sun));
        });
        let (mask, counts) = sweep_mask::<true, i16>(&nodes, sun);
        let share = |v: u64| v as f64 / rays;
        let dark = mask.iter().filter(|&&v| v == 0).count();
        print_row(
            "sweep",
            elevation_deg,
            seconds.map(|s| rays / s / 1e6),
            [counts.heights, counts.bounds, counts.steps].map(share),
            share(dark as u64),
        );
        let mut single = (vec![0u8; columns * rows], Counts64::default());
        let seconds = timed(1, || single = cast_all(&planet, &dense, sun));
        let (lit, counts) = single;
        let differ = lit.iter().zip(&mask).filter(|(a, b)| a != b).count();
        let dark = lit.iter().filter(|&&v| v == 0).count();
        print_row(
            "exact",
            elevation_deg,
            seconds.map(|s| rays / s / 1e6),
            [counts.0, counts.1, counts.2].map(share),
            share(dark as u64),
        );
        println!("        {differ} nodes differ");
    }
    println!("nodes {} bytes as f32, dense {} bytes", 4 * dense.nodes_m().len(), dense.bytes());
    Ok(())
}

#[derive(Clone, Copy, Default)]
struct Counts64(u64, u64, u64);

fn cast_all(planet: &Planet, dense: &Dense, sun: [f32; 3]) -> (Vec<u8>, Counts64) {
    let (columns, shift) = (dense.columns(), 31 - planet.m);
    let mut lit = vec![0u8; columns * dense.rows()];
    let counts = lit
        .par_chunks_mut(columns)
        .enumerate()
        .map(|(j, out)| {
            let mut sum = Counts64::default();
            for (i, out) in out.iter_mut().enumerate() {
                let place = [(i as u32) << shift, (j as u32) << shift];
                let light = shadow_exact(planet, &mut &*dense, place, dense.row_m(j)[i], 0, sun, 0.0);
                *out = light.visible as u8;
                let Counts { heights, extremes, steps } = light.counts;
                sum = Counts64(sum.0 + u64::from(heights), sum.1 + u64::from(extremes), sum.2 + u64::from(steps));
            }
            sum
        })
        .reduce(Counts64::default, |a, b| Counts64(a.0 + b.0, a.1 + b.1, a.2 + b.2));
    (lit, counts)
}

/// Seconds of one run: wall, and of a processor.
fn timed(runs: usize, mut work: impl FnMut()) -> [f64; 2] {
    let cpu = cpu_seconds();
    let mut walls: Vec<f64> = (0..runs)
        .map(|_| {
            let begin = Instant::now();
            work();
            begin.elapsed().as_secs_f64()
        })
        .collect();
    let cpu = (cpu_seconds() - cpu) / runs as f64;
    walls.sort_by(f64::total_cmp);
    [walls[runs / 2], cpu]
}

/// Processor time of this process, in hundredths of a second; 0 where the system does not tell.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(11).take(2).filter_map(|v| v.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn print_row(kernel: &str, elevation_deg: f64, [wall, cpu]: [f64; 2], counts: [f64; 3], dark: f64) {
    let [heights, extremes, steps] = counts;
    println!(
        "{kernel:6} {elevation_deg:10} {wall:8.2} {cpu:9.2} {heights:8.2} {extremes:9.2} {steps:7.2} {:8.2}",
        100.0 * dark
    );
}
