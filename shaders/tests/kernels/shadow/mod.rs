//! The exact shadow kernel against an f64 oracle without a pyramid.
//!
//! `SHADOW_RAYS` sets how many random rays a world gets; `SHADOW_FILES`, a list of `.relief` files
//! separated by colons, adds worlds.

mod compare;
mod hard;
mod on_gpu;
mod page_set;
mod paged;
mod plane;
mod soft;
mod worlds;

use compare::{compare, compare_with, rays};
use worlds::{earth, fractal_globe, fractal_plane, mars, moon, real_earth};

#[test]
fn planes_agree_with_the_oracle() {
    compare(&fractal_plane(9, [30.0, 30.0], 3000.0));
    compare(&fractal_plane(8, [20.0, 35.0], 800.0));
}

#[test]
fn globes_agree_with_the_oracle() {
    compare(&fractal_globe("Earth", 9, earth(), 12_000.0));
    compare(&fractal_globe("Moon", 9, moon(), 12_000.0));
    compare(&fractal_globe("Mars", 8, mars(), 20_000.0));
}

#[test]
fn the_real_earth_agrees_with_the_oracle() {
    compare(&real_earth(earth(), 1.0));
    // The same relief, steep: the Earth's on a Moon.
    compare(&real_earth(moon(), 1.0));
}

#[test]
fn files_agree_with_the_oracle() {
    for path in std::env::var("SHADOW_FILES").unwrap_or_default().split(':').filter(|p| !p.is_empty()) {
        compare(&worlds::from_file(path));
    }
}

#[test]
#[should_panic(expected = "rays disagree")]
fn a_kernel_with_a_flipped_comparison_is_found_out() {
    let world = fractal_plane(8, [30.0, 30.0], 3000.0);
    compare_with(&world, &rays(&world, 2000), |planet, dense, s, t, height_m, sun| {
        let down = [sun[0], sun[1], -sun[2]];
        relief_shaders::shadow::shadow_exact(planet, &mut &*dense, [s, t], height_m, 0, down, 0.0)
    });
}
