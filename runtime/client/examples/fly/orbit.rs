//! A way around a place, looking at it.

use relief_protocol::to_viewer::Planet;
use relief_protocol::view::View;

/// How far the place is below the horizon, degrees.
const PITCH_DEG: f64 = -40.0;

/// A circle above a planet.
pub struct Orbit {
    /// Longitude and latitude, or X and Y.
    centre: [f64; 2],
    /// In the same units, along X and Y.
    radius: [f64; 2],
    height_m: f64,
    size: [u32; 2],
    is_plane: bool,
}

impl Orbit {
    /// Around a place, or around one that most planets have.
    pub fn new(planet: &Planet, place: Option<[f64; 2]>, height_m: Option<f64>, size: [u32; 2]) -> Self {
        let [west, south, east, north] = planet.bounds;
        let centre = place.unwrap_or(match planet.plane {
            true => [(west + east) / 2.0, (south + north) / 2.0],
            false => [86.9, 28.0],
        });
        let metres_per_unit = planet.metres_per_unit.unwrap_or_else(|| {
            let degree_m = planet.a_m.unwrap_or(6.4e6).to_radians();
            // Near a pole a circle has few degrees of longitude left; the way is then no circle.
            [degree_m * centre[1].to_radians().cos().max(0.1), degree_m]
        });
        let side_m = planet.a_m.unwrap_or((north - south) * metres_per_unit[1]);
        let height_m = height_m.unwrap_or(planet.max_m + 0.05 * side_m);
        let radius_m = height_m / PITCH_DEG.to_radians().tan().abs();
        Self { centre, radius: metres_per_unit.map(|metres| radius_m / metres), height_m, size, is_plane: planet.plane }
    }

    /// One of so many views on the way around, clockwise from the south.
    pub fn view(&self, step: u32, steps: u32) -> View {
        let heading_deg = 360.0 * f64::from(step) / f64::from(steps.max(1));
        let (sin, cos) = heading_deg.to_radians().sin_cos();
        let [x, y] = self.centre;
        let [radius_x, radius_y] = self.radius;
        let south = if self.is_plane { f64::NEG_INFINITY } else { -90.0 };
        let y_there = (y - radius_y * cos).clamp(south, -south);
        let pose = vec![x - radius_x * sin, y_there, self.height_m, heading_deg, PITCH_DEG];
        View { pose, ..View::down([x, y, self.height_m], self.size) }
    }
}
