//! What scheme `paper` promises, over random and hard views of small planets: watertight with its
//! fillers, positions exact, nothing visible culled; its error is measured and reported. Planets,
//! cameras and the check of edges are those of scheme `leb`.

#![allow(clippy::unwrap_used, reason = "a test ends at the first thing that goes wrong")]

#[allow(dead_code, reason = "not all of it is used here")]
#[path = "../tessellation/camera.rs"]
mod camera;
#[allow(dead_code, reason = "not all of it is used here")]
#[path = "../tessellation/checks.rs"]
mod checks;
#[path = "../tessellation/deviation.rs"]
mod deviation;
#[allow(dead_code, reason = "not all of it is used here")]
#[path = "../tessellation/page_set.rs"]
mod page_set;
#[path = "../tessellation/planet.rs"]
mod planet;
#[allow(dead_code, reason = "not all of it is used here")]
#[path = "../tessellation/scene.rs"]
mod scene;
#[path = "../tessellation/views.rs"]
mod views;

mod cover;
mod gpu;
mod kernels;
mod promises;
