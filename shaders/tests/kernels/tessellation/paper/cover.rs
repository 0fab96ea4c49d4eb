//! What is drawn over a place, and how far it is from S_0 there.

use std::collections::HashMap;

use relief_shaders::leb::ReliefTriangle;
use relief_shaders::paper::Patch;
use relief_shaders::paper::patch::{level, start, start_count};
use relief_shaders::planet::Planet;

use crate::tessellation::camera::Vec3;
use crate::tessellation::planet::hash;
use crate::tessellation::scene::{Scene, drawn_point, places, weights};

/// Drawn relief triangles by their corners; fillers cover nothing.
pub struct Cover<'a> {
    planet: Planet,
    drawn: HashMap<[[u32; 2]; 3], &'a ReliefTriangle>,
}

impl<'a> Cover<'a> {
    pub fn new(planet: Planet, triangles: &'a [ReliefTriangle]) -> Self {
        Self { planet, drawn: triangles.iter().map(|t| (places(t), t)).collect() }
    }

    /// What is drawn over (S, T).
    pub fn find(&self, s: f64, t: f64) -> Over<'a> {
        let over = |patch: &Patch| weights(patch.corners(), s, t).iter().all(|&w| w >= -1e-12);
        let mut at = (0..start_count(&self.planet)).map(|i| start(&self.planet, i)).find(over);
        let mut none = Over::Nothing;
        while let Some(patch) = at {
            let corners = patch.corners();
            if let Some(found) = self.drawn.get(&corners) {
                return if level(&self.planet, &patch) < 0 { Over::Finest } else { Over::Coarser(found) };
            }
            if self.planet.plane == 0 && corners.iter().filter(|c| c[1] == 0 || c[1] == 1 << 31).count() > 1 {
                none = Over::Line;
            }
            at = if level(&self.planet, &patch) < 0 { None } else { patch.parts([false; 3]).into_iter().find(over) };
        }
        none
    }
}

/// What is drawn over a place.
pub enum Over<'a> {
    /// Half a level-0 cell, which the scheme does not refine.
    Finest,
    /// A triangle that could have been split.
    Coarser(&'a ReliefTriangle),
    /// Within a patch with two corners on a pole, which may have been left out for having no area.
    Line,
    /// Nothing.
    Nothing,
}

/// Errors in pixels at points of S_0 that rays through the picture meet, where the triangle drawn
/// could have been split.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// Rays that met the ground in view.
    pub rays: usize,
    /// Rays of them that count for the errors.
    pub counted: usize,
    /// The largest.
    pub largest_px: f64,
    /// Sum of squares.
    pub squares_px2: f64,
}

impl Errors {
    pub fn rms_px(&self) -> f64 {
        (self.squares_px2 / self.counted.max(1) as f64).sqrt()
    }
}

/// Shoots rays through the picture. `Err` where one meets ground over which nothing is drawn:
/// something visible was culled.
pub fn look(scene: &Scene<'_>, rays: u64, seed: u64) -> Result<Errors, String> {
    let cover = Cover::new(scene.pages.planet, &scene.mesh.triangles);
    let (camera, axes) = (&scene.camera, scene.camera.axes(scene.planet));
    let mut errors = Errors::default();
    for n in 0..rays {
        let [x, y] = [4, 5].map(|k| (hash(n, k, seed) % 20001) as f64 / 10000.0 - 1.0);
        let (x, y) = (x * camera.tan_x(), y * camera.tan_y());
        let d: Vec3 = [0, 1, 2].map(|i| axes[2][i] + axes[0][i] * x + axes[1][i] * y);
        let Some([s, t]) = scene.first_hit(d, 1500) else { continue };
        let p = camera.relative_m(scene.planet, s, t, scene.planet.height_m(s, t));
        let truth = camera.project(&axes, p);
        if !camera.sees(truth) {
            continue;
        }
        errors.rays += 1;
        match cover.find(s, t) {
            Over::Coarser(triangle) => {
                let drawn = camera.project(&axes, drawn_point(scene, triangle, weights(places(triangle), s, t)));
                let error = (drawn[0] - truth[0]).hypot(drawn[1] - truth[1]);
                errors.counted += 1;
                errors.largest_px = errors.largest_px.max(error);
                errors.squares_px2 += error * error;
            }
            Over::Nothing if !scene.is_hidden(p, 100_000) => {
                return Err(format!("nothing is drawn over {s} {t}; {camera:?}"));
            }
            Over::Finest | Over::Line | Over::Nothing => {}
        }
    }
    Ok(errors)
}
