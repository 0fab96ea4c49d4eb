//! A view: a camera, its sun and the size of its picture, checked and made ready for the kernels.

mod camera;
mod error;
mod sun;

use relief_shaders::planet as shared;

use crate::planet::Planet;

pub use camera::Camera;
pub use error::ViewError;
pub use sun::Sun;

/// Distance of the near plane, metres. Depth is reversed and its far plane infinite, so a small
/// value costs no precision.
pub const NEAR_M: f32 = 0.05;
/// Angular radius of the Sun's disk seen from the Earth, degrees.
pub const SUN_RADIUS_DEG: f64 = 0.2666;

/// What is looked at, and how exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
    /// Where the light comes from.
    pub sun: Sun,
    /// Angular radius of the sun's disk, degrees; 0 gives shadows a hard edge.
    pub sun_radius_deg: f64,
    /// Pixels by which the drawn surface may be away from S_0.
    pub pixel_error: f32,
}

impl View {
    /// A view with a threshold of one pixel and hard shadows.
    #[must_use]
    pub fn new(camera: Camera, [width, height]: [u32; 2], sun: Sun) -> Self {
        Self { camera, width, height, sun, sun_radius_deg: 0.0, pixel_error: 1.0 }
    }

    /// The view as the kernels see it. All is worked out in f64 and rounded once.
    ///
    /// # Errors
    /// [`ViewError`] for a number that shows nothing, or a camera of another kind of body.
    pub fn uniform(&self, planet: &Planet) -> Result<shared::View, ViewError> {
        self.check(planet)?;
        let camera = &self.camera;
        let frame = camera.frame(planet);
        let [right, up, forward] = camera.axes(&frame);
        let tan_y = (camera.fov_deg / 2.0).to_radians().tan();
        let tan_x = tan_y * f64::from(self.width) / f64::from(self.height);
        let focal_px = f64::from(self.height) / (2.0 * tan_y);
        let (n0_m, w0) = match planet.ellipsoid() {
            Some(e) => {
                (e.prime_vertical_radius_m(frame.lat_rad), (1.0 - e.e2() * frame.sin_lat * frame.sin_lat).sqrt())
            }
            None => (0.0, 1.0),
        };
        let high_m = camera.height_m as f32;
        let sun = self.sun.in_frame(&frame);
        Ok(shared::View {
            camera_s: camera.s,
            camera_t: camera.t,
            width: self.width,
            height: self.height,
            camera_h_hi_m: high_m,
            camera_h_lo_m: (camera.height_m - f64::from(high_m)) as f32,
            sin_lat: frame.sin_lat as f32,
            cos_lat: frame.cos_lat as f32,
            n0_m: n0_m as f32,
            w0: w0 as f32,
            tan_x: tan_x as f32,
            tan_y: tan_y as f32,
            right: with(right, focal_px as f32),
            up: with(up, self.pixel_error),
            forward: with(forward, NEAR_M),
            sun: with(sun, self.sun_radius_deg.to_radians() as f32),
        })
    }

    fn check(&self, planet: &Planet) -> Result<(), ViewError> {
        self.camera.check(planet)?;
        self.sun.check(planet)?;
        if self.width == 0 || self.height == 0 {
            return Err(ViewError::Size { width: self.width, height: self.height, limit: None });
        }
        if !(self.pixel_error > 0.0 && self.pixel_error <= 1e4) {
            return Err(ViewError::Number {
                what: "pixel error",
                value: f64::from(self.pixel_error),
                rule: "above 0, at most 10000 pixels",
            });
        }
        if !(0.0..=45.0).contains(&self.sun_radius_deg) {
            return Err(ViewError::Number {
                what: "radius of the sun's disk",
                value: self.sun_radius_deg,
                rule: "0 to 45 degrees",
            });
        }
        Ok(())
    }
}

fn with(v: [f64; 3], fourth: f32) -> [f32; 4] {
    [v[0] as f32, v[1] as f32, v[2] as f32, fourth]
}

#[cfg(test)]
mod tests;
