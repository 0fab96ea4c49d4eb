//! What the heights stand on: an ellipsoid of revolution, or a flat map.

use serde::{Deserialize, Serialize};

/// The reference surface of a planet file. Heights are metres along its normal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Body {
    /// An ellipsoid of revolution with semi-axes `a_m` (equator) and `b_m` (pole), in metres.
    Ellipsoid {
        /// `earth`, `moon`, `mars`, or the semi-axes as the user gave them.
        name: String,
        /// Equatorial semi-axis, metres.
        a_m: f64,
        /// Polar semi-axis, metres.
        b_m: f64,
    },
    /// A square metric map without wrap: node (i, j) lies at
    /// (`x0` + i `dx`, `y0` + j `dy`) in the units of the source's CRS.
    Plane {
        /// The CRS as WKT, empty when the source had none.
        crs_wkt: String,
        /// Easting of node (0, 0): the centre of the source's lower-left pixel.
        x0: f64,
        /// Northing of node (0, 0).
        y0: f64,
        /// Spacing of level-0 nodes eastwards, CRS units, positive.
        dx: f64,
        /// Spacing of level-0 nodes northwards, CRS units, positive.
        dy: f64,
    },
}

impl Body {
    /// WGS-84.
    #[must_use]
    pub fn earth() -> Self {
        let (a_m, inverse_flattening) = (6_378_137.0, 298.257_223_563);
        Self::Ellipsoid { name: "earth".into(), a_m, b_m: a_m - a_m / inverse_flattening }
    }

    /// IAU 2015 Moon, a sphere.
    #[must_use]
    pub fn moon() -> Self {
        Self::Ellipsoid { name: "moon".into(), a_m: 1_737_400.0, b_m: 1_737_400.0 }
    }

    /// IAU 2015 Mars, the ellipsoid of revolution.
    #[must_use]
    pub fn mars() -> Self {
        Self::Ellipsoid { name: "mars".into(), a_m: 3_396_190.0, b_m: 3_376_200.0 }
    }

    /// True for the flat body.
    #[must_use]
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Plane { .. })
    }
}
