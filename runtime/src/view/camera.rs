//! Where the camera is, and which way it looks.

use relief_formats::body::Body;
use relief_formats::geodesy::{lat_deg, lon_deg, s_from_lon_deg, sin_cos_deg, t_from_lat_deg};

use super::ViewError;
use super::error::kind;
use crate::planet::Planet;

/// The narrowest field of view.
const LEAST_FOV_DEG: f64 = 1e-3;

/// A camera in fixed-point coordinates.
///
/// Heading turns clockwise from north, pitch is 0 at the horizontal and -90 straight down, roll
/// tilts the camera clockwise; degrees. Straight down, heading says what is up in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// True on a plane.
    pub plane: bool,
    /// Longitude, 2^32 units a turn (a plane: 2^31 units a side).
    pub s: u32,
    /// Latitude from the South Pole, 2^31 units to the North Pole (a plane: a side).
    pub t: u32,
    /// Height above the ellipsoid or the plane, metres.
    pub height_m: f64,
    /// Degrees.
    pub heading_deg: f64,
    /// Degrees.
    pub pitch_deg: f64,
    /// Degrees.
    pub roll_deg: f64,
    /// Vertical field of view, degrees, above 0 and below 180.
    pub fov_deg: f64,
}

/// The camera's frame (see `relief_shaders::planet::View`) against the local horizon and ECEF.
pub(super) struct Frame {
    pub plane: bool,
    pub lat_rad: f64,
    pub sin_lat: f64,
    pub cos_lat: f64,
    pub sin_lon: f64,
    pub cos_lon: f64,
}

impl Camera {
    /// A camera over a globe, looking straight down with north up, 60 degrees of field.
    ///
    /// # Errors
    /// [`ViewError::Angle`] for a place that is none.
    pub fn over_globe(lon_deg: f64, lat_deg: f64, height_m: f64) -> Result<Self, ViewError> {
        Ok(Self::down(false, s_from_lon_deg(lon_deg)?, t_from_lat_deg(lat_deg)?, height_m))
    }

    /// A camera over a plane at (x, y) in the units of its CRS, looking straight down.
    ///
    /// # Errors
    /// [`ViewError::Number`] for a place off the map, [`ViewError::Body`] for a globe.
    pub fn over_plane(planet: &Planet, x: f64, y: f64, height_m: f64) -> Result<Self, ViewError> {
        let &Body::Plane { x0, y0, dx, dy, .. } = planet.relief().body() else {
            return Err(ViewError::Body { what: "camera", given: kind(true), file: kind(false) });
        };
        let grid = planet.grid();
        let fixed = |what, value: f64, first: f64, step: f64, cells: u32| {
            let share = (value - first) / (step * f64::from(cells));
            if (0.0..=1.0).contains(&share) {
                Ok((share * f64::from(1u32 << 31)).round() as u32)
            } else {
                Err(ViewError::Number { what, value, rule: "on the map" })
            }
        };
        let s = fixed("easting", x, x0, dx, grid.width(0))?;
        let t = fixed("northing", y, y0, dy, grid.height(0))?;
        Ok(Self::down(true, s, t, height_m))
    }

    fn down(plane: bool, s: u32, t: u32, height_m: f64) -> Self {
        Self { plane, s, t, height_m, heading_deg: 0.0, pitch_deg: -90.0, roll_deg: 0.0, fov_deg: 60.0 }
    }

    /// The same camera turned to heading, pitch and roll, degrees.
    #[must_use]
    pub fn looking(self, heading_deg: f64, pitch_deg: f64, roll_deg: f64) -> Self {
        Self { heading_deg, pitch_deg, roll_deg, ..self }
    }

    /// The same camera with another vertical field of view, degrees.
    #[must_use]
    pub fn with_fov(self, fov_deg: f64) -> Self {
        Self { fov_deg, ..self }
    }

    /// The camera that looks through one pixel of this one's picture: a view of it of 1 x 1 pixels
    /// shows what that pixel shows. `at` counts pixels from the left and from the top edge; the
    /// first one's centre lies at 0.5, 0.5.
    #[must_use]
    pub fn through(&self, [width, height]: [u32; 2], at: [f64; 2]) -> Self {
        let (sin_h, cos_h) = sin_cos_deg(self.heading_deg);
        let (sin_p, cos_p) = sin_cos_deg(self.pitch_deg);
        let (sin_r, cos_r) = sin_cos_deg(self.roll_deg);
        let side = 2.0 * (self.fov_deg / 2.0).to_radians().tan() / f64::from(height);
        let (x, y) = ((at[0] - f64::from(width) / 2.0) * side, (f64::from(height) / 2.0 - at[1]) * side);
        // East, north, up: forward, and the picture's axes before the roll.
        let forward = [sin_h * cos_p, cos_h * cos_p, sin_p];
        let level = [cos_h, -sin_h, 0.0];
        let upright = [-sin_h * sin_p, -cos_h * sin_p, cos_p];
        let (right, up) = (x * cos_r + y * sin_r, y * cos_r - x * sin_r);
        let [east, north, high]: [f64; 3] = std::array::from_fn(|k| forward[k] + right * level[k] + up * upright[k]);
        Self {
            heading_deg: east.atan2(north).to_degrees(),
            pitch_deg: high.atan2(east.hypot(north)).to_degrees(),
            roll_deg: 0.0,
            // The pixel's angle: smaller away from the centre, as its side is seen from further off.
            fov_deg: (2.0 * (side / 2.0 / (1.0 + x * x + y * y).sqrt()).atan().to_degrees()).max(LEAST_FOV_DEG),
            ..*self
        }
    }

    pub(super) fn check(&self, planet: &Planet) -> Result<(), ViewError> {
        if self.plane != planet.grid().plane {
            return Err(ViewError::Body { what: "camera", given: kind(self.plane), file: kind(!self.plane) });
        }
        let number = |what, value: f64, good: bool, rule| match good {
            true => Ok(()),
            false => Err(ViewError::Number { what, value, rule }),
        };
        let limit_m = planet.ellipsoid().map_or(1e9, |e| 1e3 * e.a_m.max(e.b_m));
        let turn = "a finite number of degrees, at most 1e6";
        number("camera height", self.height_m, self.height_m.abs() <= limit_m, "finite, within a thousand radii")?;
        number("heading", self.heading_deg, self.heading_deg.abs() <= 1e6, turn)?;
        number("roll", self.roll_deg, self.roll_deg.abs() <= 1e6, turn)?;
        number("pitch", self.pitch_deg, self.pitch_deg.abs() <= 90.0, "-90 to 90 degrees")?;
        let fov = self.fov_deg;
        number("field of view", fov, (LEAST_FOV_DEG..=170.0).contains(&fov), "0.001 to 170 degrees")?;
        number("latitude", f64::from(self.t), self.t <= 1 << 31, "at most 2^31 units")?;
        number("easting", f64::from(self.s), !self.plane || self.s <= 1 << 31, "at most 2^31 units")
    }

    pub(super) fn frame(&self, planet: &Planet) -> Frame {
        if planet.grid().plane {
            return Frame { plane: true, lat_rad: 0.0, sin_lat: 0.0, cos_lat: 1.0, sin_lon: 0.0, cos_lon: 1.0 };
        }
        let lat = lat_deg(self.t);
        let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = (sin_cos_deg(lat), sin_cos_deg(lon_deg(self.s)));
        Frame { plane: false, lat_rad: lat.to_radians(), sin_lat, cos_lat, sin_lon, cos_lon }
    }

    /// Unit vectors to the right, up and forward, in the camera's frame.
    pub(super) fn axes(&self, frame: &Frame) -> [[f64; 3]; 3] {
        let (sin_h, cos_h) = sin_cos_deg(self.heading_deg);
        let (sin_p, cos_p) = sin_cos_deg(self.pitch_deg);
        let (sin_r, cos_r) = sin_cos_deg(self.roll_deg);
        // East, north, up.
        let forward = [sin_h * cos_p, cos_h * cos_p, sin_p];
        let level = [cos_h, -sin_h, 0.0];
        let upright = [-sin_h * sin_p, -cos_h * sin_p, cos_p];
        let right = std::array::from_fn(|k| cos_r * level[k] - sin_r * upright[k]);
        let up = std::array::from_fn(|k| cos_r * upright[k] + sin_r * level[k]);
        [right, up, forward].map(|v| frame.of_horizon(v))
    }
}

impl Frame {
    /// A vector (east, north, up) of the camera's horizon in the camera's frame.
    pub fn of_horizon(&self, [east, north, up]: [f64; 3]) -> [f64; 3] {
        if self.plane {
            return [east, north, up];
        }
        [up * self.cos_lat - north * self.sin_lat, east, north * self.cos_lat + up * self.sin_lat]
    }

    /// A vector in ECEF in the camera's frame.
    pub fn of_ecef(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [self.cos_lon * x + self.sin_lon * y, self.cos_lon * y - self.sin_lon * x, z]
    }
}
