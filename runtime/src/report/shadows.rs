//! Shadows by kernel and level: rays a second, fetches a ray, wrong answers against the oracle.

use std::time::Instant;

use rayon::prelude::*;
use relief_formats::file::FormatError;
use relief_shaders::oracle::World;
use relief_shaders::shadow::dense::Dense;
use relief_shaders::shadow::paper::{PaperMap, Reading};
use relief_shaders::shadow::sweep::{PlaneNodes, sweep_mask};
use relief_shaders::shadow::{Sunlight, shadow_exact};

use super::{Options, ReportError};
use crate::frame::RenderError;
use crate::planet::Planet;

/// Suns, degrees above the horizon.
const ELEVATIONS_DEG: [f64; 4] = [2.0, 5.0, 10.0, 20.0];
/// Azimuth of the sun when a whole plane is shaded, degrees: along neither axis nor diagonal.
const AZIMUTH_DEG: f64 = 123.0;
/// Rows of the finest level that is held dense.
const MOST_ROWS_LOG2: u32 = 11;
/// Coarser surfaces than the finest that are tried.
const OFFSETS: u32 = 3;

/// The paper's kernel as it is printed, and as it is meant: baselines.
pub const PAPER: [&str; 2] = ["paper, printed", "paper, meant"];

/// One kernel under one sun.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowRow {
    /// Elevation of the sun, degrees.
    pub elevation_deg: f64,
    /// `exact`; on planes also `sweep`, where all nodes are shaded at once, and the paper's as
    /// [`PAPER`] names them.
    pub kernel: &'static str,
    /// Levels by which the surface that is tested is coarser than the truth.
    pub level_offset: u32,
    /// Rays.
    pub rays: usize,
    /// Million rays a second, all cores.
    pub mray_per_s: f64,
    /// Heights fetched a ray.
    pub heights_per_ray: f64,
    /// Pairs of extremes fetched a ray.
    pub extremes_per_ray: f64,
    /// Rays compared with the oracle.
    pub checked: usize,
    /// Of them, those that differ from it outside the margin.
    pub wrong: usize,
    /// Of them, those within the margin.
    pub inside_margin: usize,
    /// Share of rays in shadow.
    pub dark_share: f64,
}

/// A ray: fixed-point place, and the sun east, north, up.
type Ray = ([u32; 2], [f32; 3]);

pub(super) fn run(
    planet: &Planet,
    options: &Options,
    progress: &dyn Fn(&str, f64),
) -> Result<Vec<ShadowRow>, ReportError> {
    let level = planet.grid().m.saturating_sub(MOST_ROWS_LOG2);
    let mut uniform = planet.uniform();
    // The dense level is the truth here: as if the file ended with it.
    uniform.m -= level;
    uniform.root_level -= level;
    let dense = dense(planet, level).map_err(RenderError::from)?;
    let dense = Dense::from_nodes(&uniform, 0, dense);
    let world = world(planet, &dense, &uniform);
    let paper = planet.grid().plane.then(|| paper_map(&dense, &world));
    let mut rows = Vec::new();
    for (n, elevation_deg) in ELEVATIONS_DEG.into_iter().enumerate() {
        progress("shadows", n as f64 / ELEVATIONS_DEG.len() as f64);
        let rays = rays(&world, options.rays, elevation_deg);
        let truth: Vec<_> = rays[..options.checked.min(rays.len())]
            .par_iter()
            .map(|&([s, t], sun)| {
                let margin = world.margin(s, t, sun.map(f64::from), 0.0);
                (!margin.is_inside()).then_some(margin.angle_rad > 0.0)
            })
            .collect();
        let offsets = 0..OFFSETS.min(uniform.root_level + 1);
        for level_offset in offsets.clone() {
            rows.push(single(("exact", level_offset, elevation_deg), &rays, &truth, |&(at, sun)| {
                let height_m = world.height_m(at[0], at[1]) as f32;
                shadow_exact(&uniform, &mut &dense, at, height_m, level_offset, sun, 0.0)
            }));
        }
        if planet.grid().plane {
            rows.push(sweep(&world, &dense, elevation_deg, options.checked));
        }
        if let Some(map) = &paper {
            for (kernel, reading) in [(PAPER[0], Reading::Printed), (PAPER[1], Reading::Meant)] {
                for level_offset in offsets.clone() {
                    rows.push(single((kernel, level_offset, elevation_deg), &rays, &truth, |&(at, sun)| {
                        // Texels' centres are the nodes; a ray starts on the level's own surface.
                        let [x, y] = at.map(|v| (v >> (31 - uniform.m)) as f32 + 0.5);
                        map.paper_shadow([x, y], map.paper_bilinear_m(level_offset, x, y), level_offset, sun, reading)
                    }));
                }
            }
        }
    }
    Ok(rows)
}

/// Rays one by one: kernel, level offset and elevation; the truth of the first ones, none within the
/// margin.
fn single(
    (kernel, level_offset, elevation_deg): (&'static str, u32, f64),
    rays: &[Ray],
    truth: &[Option<bool>],
    cast: impl Fn(&Ray) -> Sunlight + Sync + Send,
) -> ShadowRow {
    let begin = Instant::now();
    let light: Vec<Sunlight> = rays.par_iter().map(cast).collect();
    let seconds = begin.elapsed().as_secs_f64();
    let each =
        |count: fn(&Sunlight) -> u32| light.iter().map(|l| f64::from(count(l))).sum::<f64>() / light.len() as f64;
    let wrong = truth.iter().zip(&light).filter(|(truth, l)| truth.is_some_and(|dark| dark != (l.visible == 0.0)));
    ShadowRow {
        elevation_deg,
        kernel,
        level_offset,
        rays: rays.len(),
        mray_per_s: rays.len() as f64 / seconds / 1e6,
        heights_per_ray: each(|l| l.counts.heights),
        extremes_per_ray: each(|l| l.counts.extremes),
        checked: truth.len(),
        wrong: wrong.count(),
        inside_margin: truth.iter().filter(|truth| truth.is_none()).count(),
        dark_share: each(|l| u32::from(l.visible == 0.0)),
    }
}

/// All nodes of a plane under one sun.
fn sweep(world: &World, dense: &Dense, elevation_deg: f64, checked: usize) -> ShadowRow {
    let nodes = PlaneNodes {
        samples: dense.nodes_m(),
        base: 0.0,
        unit_m: 1.0,
        columns: dense.columns(),
        rows: dense.rows(),
        spacing_m: world.spacing_m,
    };
    let sun = towards(AZIMUTH_DEG, elevation_deg);
    let begin = Instant::now();
    let (mask, _) = sweep_mask::<false, f32>(&nodes, sun);
    let seconds = begin.elapsed().as_secs_f64();
    let (_, counts) = sweep_mask::<true, f32>(&nodes, sun);
    let (shift, mut random) = (31 - world.m, Random(9));
    let picks: Vec<usize> = (0..checked).map(|_| (random.bits() % mask.len() as u64) as usize).collect();
    let (wrong, inside_margin) = picks
        .par_iter()
        .map(|&k| {
            let [i, j] = [k % dense.columns(), k / dense.columns()].map(|v| (v as u32) << shift);
            let margin = world.margin(i, j, sun.map(f64::from), 0.0);
            let inside = margin.is_inside();
            (usize::from(!inside && (mask[k] == 0) != (margin.angle_rad > 0.0)), usize::from(inside))
        })
        .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    let all = mask.len() as f64;
    ShadowRow {
        elevation_deg,
        kernel: "sweep",
        level_offset: 0,
        rays: mask.len(),
        mray_per_s: all / seconds / 1e6,
        heights_per_ray: counts.heights as f64 / all,
        extremes_per_ray: counts.bounds as f64 / all,
        checked,
        wrong,
        inside_margin,
        dark_share: mask.iter().filter(|&&lit| lit == 0).count() as f64 / all,
    }
}

/// (columns + 1) x (rows + 1) heights of a level, metres.
fn dense(planet: &Planet, level: u32) -> Result<Vec<f32>, FormatError> {
    Ok(Dense::from_tiles(&planet.uniform(), planet.tiles(), level)?.nodes_m().to_vec())
}

/// The paper's pyramids over the dense level, without its far edges.
fn paper_map(dense: &Dense, world: &World) -> PaperMap {
    let texels = (0..dense.rows()).flat_map(|y| &dense.row_m(y)[..dense.columns()]).copied().collect();
    PaperMap::new(world.m, world.spacing_m.map(|v| v as f32), texels)
}

fn world(planet: &Planet, dense: &Dense, uniform: &relief_shaders::planet::Planet) -> World {
    let cell = f64::from(31 - uniform.m).exp2();
    World {
        name: "file",
        m: uniform.m,
        ellipsoid: planet.ellipsoid(),
        spacing_m: [uniform.unit_x_m, uniform.unit_y_m].map(|unit_m| f64::from(unit_m) * cell),
        nodes_m: dense.nodes_m().to_vec(),
    }
}

/// Rays from nodes that every tested level has, evenly over the body, to all azimuths.
fn rays(world: &World, count: usize, elevation_deg: f64) -> Vec<Ray> {
    let mut random = Random(elevation_deg.to_bits());
    let shift = 31 - world.m + OFFSETS - 1;
    (0..count)
        .map(|_| {
            let t = match world.ellipsoid {
                Some(_) => ((2.0 * random.unit() - 1.0).asin() / std::f64::consts::PI + 0.5) * 2_147_483_648.0,
                None => random.unit() * 2_147_483_648.0,
            };
            let s = random.bits() as u32 >> u32::from(world.ellipsoid.is_none());
            ([s >> shift << shift, t as u32 >> shift << shift], towards(360.0 * random.unit(), elevation_deg))
        })
        .collect()
}

fn towards(azimuth_deg: f64, elevation_deg: f64) -> [f32; 3] {
    let ((sa, ca), (se, ce)) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
    [ce * sa, ce * ca, se].map(|v| v as f32)
}

/// Marsaglia's xorshift: the same rays in every report.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}
