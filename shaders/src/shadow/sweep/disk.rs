//! A plane under the sun's disk: two sweeps tell which nodes see all of it or nothing, and single
//! rays how much the others see.

use rayon::prelude::*;

use super::{PlaneNodes, sweep_mask};
use crate::planet::Planet;
use crate::shadow::exact::{Relief, shadow_exact};
use crate::shadow::square::square_shift;
use crate::shadow::sun::disk_slopes;

/// Visible part of the disk at every node of a level of a plane, 0 to 255, columns x rows, south
/// row first. Each thread makes its own `relief`, whose heights are those of `nodes`.
///
/// # Panics
/// When the number of samples is not that of the grid.
#[must_use]
pub fn sweep_disk<H: Copy + Into<f32> + Sync, R: Relief>(
    planet: &Planet,
    nodes: &PlaneNodes<'_, H>,
    level: u32,
    relief: impl Fn() -> R + Sync,
    sun: [f32; 3],
    disk_rad: f32,
) -> Vec<u8> {
    let [east, north, up] = sun;
    let limbs = disk_slopes(sun, disk_rad);
    let [mut light, upper] = limbs.map(|slope| sweep_mask::<false, H>(nodes, [east, north, up + slope]).0);
    let shift = square_shift(planet, level);
    light.par_chunks_mut(nodes.columns).zip(upper.par_chunks(nodes.columns)).enumerate().for_each(
        |(j, (row, upper))| {
            let mut relief = relief();
            for (i, (lower, upper)) in row.iter_mut().zip(upper).enumerate() {
                *lower = match (*lower, *upper) {
                    (1, _) => 255,
                    (_, 0) => 0,
                    _ => {
                        let height_m = nodes.height_m(nodes.samples[j * (nodes.columns + 1) + i]);
                        let place = [(i as u32) << shift, (j as u32) << shift];
                        let part = shadow_exact(planet, &mut relief, place, height_m, level, sun, disk_rad).visible;
                        (part * 255.0 + 0.5) as u8
                    }
                };
            }
        },
    );
    light
}
