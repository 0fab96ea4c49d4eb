//! Where the light comes from. The sun is infinitely far away.

use relief_formats::geodesy::{Ellipsoid, lat_deg, lon_deg, sin_cos_deg};

use super::ViewError;
use super::camera::Frame;
use super::error::kind;
use crate::planet::Planet;

/// The sun's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sun {
    /// Over a globe: towards the sun, unit vector in ECEF.
    Ecef([f64; 3]),
    /// Over a plane: towards the sun, unit vector (east, north, up).
    Local([f64; 3]),
}

impl Sun {
    /// The sun in the zenith of a place of a globe, geodetic degrees.
    ///
    /// # Errors
    /// [`ViewError::Number`] for what names no place.
    pub fn over(lon_deg: f64, lat_deg: f64) -> Result<Self, ViewError> {
        finite("sub-solar longitude", lon_deg, 1e6, "a finite number of degrees, at most 1e6")?;
        finite("sub-solar latitude", lat_deg, 90.0, "-90 to 90 degrees")?;
        Ok(Self::Ecef(Ellipsoid::normal_from_deg(lon_deg, lat_deg)))
    }

    /// The sun over a plane: azimuth clockwise from north and elevation, degrees.
    ///
    /// # Errors
    /// [`ViewError::Number`] for what is no direction.
    pub fn at(azimuth_deg: f64, elevation_deg: f64) -> Result<Self, ViewError> {
        finite("azimuth", azimuth_deg, 1e6, "a finite number of degrees, at most 1e6")?;
        finite("elevation", elevation_deg, 90.0, "-90 to 90 degrees")?;
        let ((sin_a, cos_a), (sin_e, cos_e)) = (sin_cos_deg(azimuth_deg), sin_cos_deg(elevation_deg));
        Ok(Self::Local([sin_a * cos_e, cos_a * cos_e, sin_e]))
    }

    /// Azimuth clockwise from north and elevation above the local horizon at a fixed-point place,
    /// degrees; the sun is infinitely far, and relief and refraction are left out.
    #[must_use]
    pub fn azimuth_elevation_deg(&self, [s, t]: [u32; 2]) -> [f64; 2] {
        let [east, north, up] = match *self {
            Self::Local(v) => v,
            Self::Ecef([x, y, z]) => {
                let ((sin_lon, cos_lon), (sin_lat, cos_lat)) = (sin_cos_deg(lon_deg(s)), sin_cos_deg(lat_deg(t)));
                let outward = cos_lon * x + sin_lon * y;
                [cos_lon * y - sin_lon * x, cos_lat * z - sin_lat * outward, cos_lat * outward + sin_lat * z]
            }
        };
        [east.atan2(north).to_degrees().rem_euclid(360.0), up.atan2(east.hypot(north)).to_degrees()]
    }

    pub(super) fn check(&self, planet: &Planet) -> Result<(), ViewError> {
        let (v, plane) = match *self {
            Self::Ecef(v) => (v, false),
            Self::Local(v) => (v, true),
        };
        if plane != planet.grid().plane {
            return Err(ViewError::Body { what: "sun", given: kind(plane), file: kind(!plane) });
        }
        let length = v[0].hypot(v[1]).hypot(v[2]);
        if (length - 1.0).abs() < 1e-9 {
            Ok(())
        } else {
            Err(ViewError::Number { what: "length of the sun's direction", value: length, rule: "1" })
        }
    }

    /// The direction in the camera's frame.
    pub(super) fn in_frame(&self, frame: &Frame) -> [f64; 3] {
        match *self {
            Self::Ecef(v) => frame.of_ecef(v),
            Self::Local(v) => frame.of_horizon(v),
        }
    }
}

fn finite(what: &'static str, value: f64, limit: f64, rule: &'static str) -> Result<(), ViewError> {
    if value.abs() <= limit { Ok(()) } else { Err(ViewError::Number { what, value, rule }) }
}
