//! Where the light comes from: `--sun` or `--time`.

use chrono::{DateTime, Utc};
use relief_formats::body::Body;
use relief_formats::geodesy::{lat_deg, lon_deg, sin_cos_deg};
use relief_front::error::ToolError;
use relief_runtime::planet::Planet;
use relief_runtime::sun::sub_solar_deg;
use relief_runtime::view::{Camera, Sun};

use crate::errors::{of_sun, of_view};
use crate::typed::{AnglesArg, time};

/// Either the sun's place or a time.
#[derive(Debug, clap::Args)]
#[group(multiple = false)]
pub struct SunArgs {
    /// The point with the sun in its zenith, geodetic degrees (a plane: the sun's azimuth from
    /// north and elevation)
    #[arg(long, value_name = "LON,LAT", allow_hyphen_values = true)]
    sun: Option<AnglesArg>,
    /// The sun at this time (RFC 3339) over the Earth
    #[arg(long, value_name = "TIME", value_parser = time)]
    time: Option<DateTime<Utc>>,
}

/// A sun and how it was named.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its direction.
    pub sun: Sun,
    /// Sub-solar longitude and latitude, or azimuth and elevation; degrees.
    pub angles_deg: [f64; 2],
    /// The time it was worked out from.
    pub time: Option<DateTime<Utc>>,
}

impl SunArgs {
    /// A sun named by its place, by a time, or not at all.
    pub fn new(sun: Option<AnglesArg>, time: Option<DateTime<Utc>>) -> Self {
        Self { sun, time }
    }

    /// The sun's place in degrees, or the time, as it was given.
    pub fn given(&self) -> (Option<[f64; 2]>, Option<DateTime<Utc>>) {
        (self.sun.map(|AnglesArg(angles_deg)| angles_deg), self.time)
    }

    /// The sun over a planet; none where none was asked for.
    pub fn light(&self, planet: &Planet) -> Result<Option<Light>, ToolError> {
        match (self.sun, self.time) {
            (Some(AnglesArg(angles_deg)), _) => Light::towards(planet, angles_deg).map(Some),
            (None, Some(time)) => Light::at(planet, time).map(Some),
            (None, None) => Ok(None),
        }
    }
}

/// Whether the sun's place over a planet is known from a time: over the Earth's ellipsoid.
pub fn has_time(planet: &Planet) -> bool {
    match planet.relief().body() {
        Body::Plane { .. } => false,
        Body::Ellipsoid { a_m, .. } => (a_m - 6_378_137.0).abs() <= 1e3,
    }
}

impl Light {
    /// The sun over a point of a globe, or at azimuth and elevation over a plane.
    pub fn towards(planet: &Planet, angles_deg: [f64; 2]) -> Result<Self, ToolError> {
        let of = if planet.grid().plane { Sun::at } else { Sun::over };
        let sun = of(angles_deg[0], angles_deg[1]).map_err(of_view)?;
        Ok(Self { sun, angles_deg, time: None })
    }

    /// The sun over the Earth at a time.
    pub fn at(planet: &Planet, time: DateTime<Utc>) -> Result<Self, ToolError> {
        let refused = |what: &str, remedy: &str| {
            Err(ToolError::usage(
                format!("--time for {what}"),
                "the sun's place at a time is known over the Earth's ellipsoid",
                remedy,
            ))
        };
        match planet.relief().body() {
            Body::Plane { .. } => refused("a plane", "give --sun AZIMUTH,ELEVATION"),
            Body::Ellipsoid { name, .. } if !has_time(planet) => {
                refused(&format!("the body {name}"), "give the sub-solar point with --sun LON,LAT")
            }
            Body::Ellipsoid { .. } => {
                let light = Self::towards(planet, sub_solar_deg(time).map_err(of_sun)?)?;
                Ok(Self { time: Some(time), ..light })
            }
        }
    }

    /// Light as maps have it: from the north-west of the camera's place, 45 degrees high.
    pub fn of_maps(planet: &Planet, camera: &Camera) -> Result<Self, ToolError> {
        const AZIMUTH_DEG: f64 = 315.0;
        const ELEVATION_DEG: f64 = 45.0;
        if planet.grid().plane {
            return Self::towards(planet, [AZIMUTH_DEG, ELEVATION_DEG]);
        }
        // The pole of the great circle towards the azimuth, an arc of 90 - 45 degrees away.
        let ((sin_lat, cos_lat), (sin_a, cos_a)) = (sin_cos_deg(lat_deg(camera.t)), sin_cos_deg(AZIMUTH_DEG));
        let (cos_arc, sin_arc) = sin_cos_deg(ELEVATION_DEG);
        let sin_sun = sin_lat * cos_arc + cos_lat * sin_arc * cos_a;
        let turn = (sin_a * sin_arc * cos_lat).atan2(cos_arc - sin_lat * sin_sun);
        Self::towards(planet, [lon_deg(camera.s) + turn.to_degrees(), sin_sun.clamp(-1.0, 1.0).asin().to_degrees()])
    }

    /// For names and metadata: the angles.
    pub fn angles(&self) -> String {
        format!("{:.6},{:.6}", self.angles_deg[0], self.angles_deg[1])
    }
}
