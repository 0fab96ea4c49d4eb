//! Speed and fetches of the shadow kernels on a planar file: `shadow_bench FILE.relief`.
//!
//! Every node of the plane is a ray, for four suns: by the sweep, by single exact rays, by single
//! rays without the least heights, and without any bounds, and by the paper's kernel, as it is
//! printed and as it is meant, with the share of nodes that it gets wrong. Prints one JSON object.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use relief_formats::body::Body;
use relief_formats::file::Relief;
use relief_formats::tiles::Tiles;
use relief_shaders::planet::Planet;
use relief_shaders::shadow::dense::Dense;
use relief_shaders::shadow::paper::{PaperMap, Reading};
use relief_shaders::shadow::sweep::{PlaneNodes, sweep_mask};
use relief_shaders::shadow::{Relief as Bounds, shadow_exact};

/// Azimuth of the suns, degrees.
const AZIMUTH_DEG: f64 = 135.0;
/// Every n-th node in both directions is cast by the kernels that are only counted: an odd number,
/// so that all places within the blocks of the pyramid are met.
const SPARSE: usize = 7;

/// A dense level of which only the greatest heights are known, or nothing.
#[derive(Clone, Copy)]
struct Blinkered<'a> {
    dense: &'a Dense,
    greatest: bool,
}

impl Bounds for Blinkered<'_> {
    fn extremes_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 2]> {
        let [_, greatest_m] = Bounds::extremes_m(&mut self.dense, level, x, y)?;
        Some([f32::NEG_INFINITY, if self.greatest { greatest_m } else { f32::INFINITY }])
    }

    fn corners_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 4]> {
        Bounds::corners_m(&mut self.dense, level, x, y)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: shadow_bench FILE.relief")?;
    let relief = Relief::open(Path::new(&path))?;
    let tiles = Tiles::new(&relief, 64 << 20);
    let grid = relief.grid();
    let Body::Plane { dx, dy, .. } = *relief.body() else { return Err("not a plane".into()) };
    let unit = f64::from(31 - grid.m).exp2();
    let step_m = relief.step_m() as f32;
    let header = relief.header();
    let planet = Planet {
        m: grid.m,
        plane: 1,
        root_level: grid.root_level(),
        step_m,
        min_m: header.min_q as f32 * step_m,
        max_m: header.max_q as f32 * step_m,
        unit_x_m: (dx / unit) as f32,
        unit_y_m: (dy / unit) as f32,
        ..Planet::default()
    };
    let dense = Dense::from_tiles(&planet, &tiles, 0)?;
    let (columns, rows) = (dense.columns(), dense.rows());
    let nodes = PlaneNodes { samples: dense.nodes_m(), base: 0.0, unit_m: 1.0, columns, rows, spacing_m: [dx, dy] };
    let all = (columns * rows) as f64;
    let texels = (0..rows).flat_map(|y| dense.row_m(y)[..columns].to_vec()).collect();
    let paper = PaperMap::new(grid.m, [dx as f32, dy as f32], texels);
    let mut suns = Vec::new();
    for elevation_deg in [2.0f64, 5.0, 10.0, 20.0] {
        let ((sa, ca), (se, ce)) = (AZIMUTH_DEG.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
        let sun = [ce * sa, ce * ca, se].map(|v| v as f32);
        let sweep_s = median_s(9, || drop(std::hint::black_box(sweep_mask::<false, f32>(&nodes, sun))));
        let (mask, counts) = sweep_mask::<true, f32>(&nodes, sun);
        let lit = mask.iter().filter(|&&lit| lit != 0).count() as f64 / all;
        let mut kernels = vec![row("sweep", Some(all / sweep_s / 1e6), [counts.heights, counts.bounds], all)];
        let begin = Instant::now();
        let fetched = cast_all(&planet, &dense, 1, &|| &dense, sun);
        let exact_s = begin.elapsed().as_secs_f64();
        kernels.push(row("exact", Some(all / exact_s / 1e6), fetched, all));
        let sparse = (columns.div_ceil(SPARSE) * rows.div_ceil(SPARSE)) as f64;
        for (name, greatest) in [("greatest only", true), ("no bounds", false)] {
            let blinkered = || Blinkered { dense: &dense, greatest };
            let [heights, extremes] = cast_all(&planet, &dense, SPARSE, &blinkered, sun);
            // Without bounds nothing is looked up but heights.
            kernels.push(row(name, None, [heights, if greatest { extremes } else { 0 }], sparse));
        }
        for (name, reading) in [("paper, printed", Reading::Printed), ("paper, meant", Reading::Meant)] {
            let begin = Instant::now();
            let (texels, counts) = paper.paper_mask(0, sun, reading);
            let speed = all / begin.elapsed().as_secs_f64() / 1e6;
            let wrong = texels.iter().zip(&mask).filter(|(a, b)| (**a == 0) != (**b == 0)).count() as f64 / all;
            let row = row(name, Some(speed), [counts.heights, counts.extremes], all);
            kernels.push(row.replace('}', &format!(", \"wrong\": {wrong:.6}}}")));
        }
        suns.push(format!(
            "{{\"elevation_deg\": {elevation_deg}, \"lit\": {lit:.6}, \"kernels\": [{}]}}",
            kernels.join(", ")
        ));
    }
    println!(
        "{{\"columns\": {columns}, \"rows\": {rows}, \"threads\": {}, \"suns\": [{}]}}",
        rayon::current_num_threads(),
        suns.join(", ")
    );
    Ok(())
}

fn row(name: &str, mray_s: Option<f64>, [heights, extremes]: [u64; 2], rays: f64) -> String {
    let speed = mray_s.map_or("null".into(), |v| format!("{v:.3}"));
    let (heights, extremes) = (heights as f64 / rays, extremes as f64 / rays);
    format!("{{\"kernel\": \"{name}\", \"mray_s\": {speed}, \"heights\": {heights:.3}, \"extremes\": {extremes:.3}}}")
}

/// Casts a ray from every n-th node; returns heights and pairs of extremes fetched.
fn cast_all<R: Bounds>(
    planet: &Planet,
    dense: &Dense,
    every: usize,
    relief: &(impl Fn() -> R + Sync),
    sun: [f32; 3],
) -> [u64; 2] {
    let shift = 31 - planet.m;
    (0..dense.rows())
        .into_par_iter()
        .step_by(every)
        .map(|j| {
            let mut relief = relief();
            let mut sums = [0; 2];
            for i in (0..dense.columns()).step_by(every) {
                let place = [(i as u32) << shift, (j as u32) << shift];
                let light = shadow_exact(planet, &mut relief, place, dense.row_m(j)[i], 0, sun, 0.0);
                sums[0] += u64::from(light.counts.heights);
                sums[1] += u64::from(light.counts.extremes);
            }
            sums
        })
        .reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
}

fn median_s(runs: usize, mut work: impl FnMut()) -> f64 {
    let mut walls: Vec<f64> = (0..runs)
        .map(|_| {
            let begin = Instant::now();
            work();
            begin.elapsed().as_secs_f64()
        })
        .collect();
    walls.sort_by(f64::total_cmp);
    walls[runs / 2]
}
