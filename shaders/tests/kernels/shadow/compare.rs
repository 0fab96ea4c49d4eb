//! Random rays through kernel and oracle.

use rayon::prelude::*;
use relief_shaders::planet::Planet;
use relief_shaders::shadow::dense::Dense;
use relief_shaders::shadow::{Counts, Sunlight, shadow_exact};

use crate::shadow::worlds::{dense, planet};
use relief_shaders::oracle::World;

/// Start in fixed point, and the sun (east, north, up).
pub type Cast = (u32, u32, [f32; 3]);

/// A generator of well mixed numbers.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut v = self.0;
        v = (v ^ (v >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        v = (v ^ (v >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        v ^ (v >> 31)
    }

    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}

pub fn sun(azimuth_deg: f64, elevation_deg: f64) -> [f32; 3] {
    let ((sa, ca), (se, ce)) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
    // Right angles exactly.
    [ce * sa, ce * ca, se].map(|v| if v.abs() < 1e-15 { 0.0 } else { v as f32 })
}

pub fn ray_count() -> usize {
    std::env::var("SHADOW_RAYS").ok().and_then(|v| v.parse().ok()).unwrap_or(4000)
}

/// Rays from nodes and between them, in all directions, most at a low sun.
pub fn rays(world: &World, count: usize) -> Vec<Cast> {
    let mut random = Random(u64::from(world.m) + 77);
    let shift = 31 - world.m;
    (0..count)
        .map(|k| {
            let mut s = random.bits() as u32;
            // Uniform on the sphere; all latitudes alike in a tenth of the rays.
            let mut t = if world.ellipsoid.is_some() && k % 10 != 0 {
                (((random.unit() * 2.0 - 1.0).asin() / std::f64::consts::PI + 0.5) * 2_147_483_648.0) as u32
            } else {
                (random.bits() >> 33) as u32
            };
            if world.ellipsoid.is_none() {
                s >>= 1;
            }
            if k % 2 == 0 {
                (s, t) = (s >> shift << shift, t >> shift << shift);
            }
            let elevation_deg = match k % 8 {
                0 => random.unit() * 90.0,
                1 => random.unit() * -5.0,
                _ => random.unit() * 20.0,
            };
            (s, t, sun(random.unit() * 360.0, elevation_deg))
        })
        .collect()
}

pub fn compare(world: &World) {
    compare_with(world, &rays(world, ray_count()), |planet, dense, s, t, height_m, sun| {
        shadow_exact(planet, &mut &*dense, [s, t], height_m, 0, sun, 0.0)
    });
}

/// Casts given rays; hard cases may lie inside the margin as often as they like.
pub fn check(world: &World, rays: &[Cast]) {
    cast_all(world, rays, |planet, dense, s, t, height_m, sun| {
        shadow_exact(planet, &mut &*dense, [s, t], height_m, 0, sun, 0.0)
    });
}

/// Casts random rays; fails if too many are inside the margin.
pub fn compare_with(
    world: &World,
    rays: &[Cast],
    kernel: impl Fn(&Planet, &Dense, u32, u32, f32, [f32; 3]) -> Sunlight + Sync,
) {
    let inside = cast_all(world, rays, kernel);
    let total = rays.len() as f64;
    assert!(inside as f64 <= 0.005 * total + 3.0, "{}: {inside} of {total} rays are inside the margin", world.name);
}

/// Casts every ray through a kernel and the oracle; fails if they differ outside the margin.
/// Returns how many are inside.
fn cast_all(
    world: &World,
    rays: &[Cast],
    kernel: impl Fn(&Planet, &Dense, u32, u32, f32, [f32; 3]) -> Sunlight + Sync,
) -> usize {
    let (planet, dense, max_m) = (planet(world), dense(world), world.max_m());
    let results: Vec<_> = rays
        .par_iter()
        .map(|&(s, t, sun)| {
            let light = kernel(&planet, &dense, s, t, world.height_m(s, t) as f32, sun);
            let norm = sun.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>().sqrt();
            let margin = world.margin_under(max_m, s, t, sun.map(|v| f64::from(v) / norm), 0.0);
            let dark = light.visible == 0.0;
            let wrong = !margin.is_inside() && dark != (margin.angle_rad > 0.0);
            (wrong, margin, light)
        })
        .collect();
    let total = rays.len() as f64;
    let inside = results.iter().filter(|(_, margin, _)| margin.is_inside()).count();
    let dark = results.iter().filter(|(_, _, light)| light.visible == 0.0).count();
    let counts = results.iter().fold(Counts::default(), |a, (_, _, light)| Counts {
        heights: a.heights + light.counts.heights,
        extremes: a.extremes + light.counts.extremes,
        steps: a.steps + light.counts.steps,
    });
    println!(
        "{}: {} rays, {:.1} % dark, {:.3} % inside the margin, per ray {:.2} heights {:.2} extremes {:.2} steps, most {}",
        world.name,
        rays.len(),
        100.0 * dark as f64 / total,
        100.0 * inside as f64 / total,
        f64::from(counts.heights) / total,
        f64::from(counts.extremes) / total,
        f64::from(counts.steps) / total,
        results.iter().map(|(_, _, light)| light.counts.steps).max().unwrap_or(0),
    );
    let wrong: Vec<_> = rays.iter().zip(&results).filter(|(_, (wrong, _, _))| *wrong).collect();
    for (ray, (_, margin, light)) in wrong.iter().take(5) {
        println!("  {ray:?} {margin:?} {light:?}");
    }
    assert!(wrong.is_empty(), "{}: {} of {} rays disagree", world.name, wrong.len(), rays.len());
    inside
}
