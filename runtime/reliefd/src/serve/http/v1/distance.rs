//! `GET /v1/planets/{name}/distance`: along the geodesic of the file's ellipsoid, as GeographicLib has
//! it (C. F. F. Karney, Algorithms for geodesics, J. Geodesy 87, 2013).

use axum::Json;
use geographiclib_rs::{Geodesic, InverseGeodesic as _};
use relief_protocol::error::{Code, Fault};
use relief_runtime::planet::Planet;
use utoipa::ToSchema;

use crate::serve::heights::off_map;
use crate::serve::http::at::At;
use crate::serve::http::refused::Refused;
use crate::serve::http::words::Words;
use crate::typed::PointArg;

/// Both ends.
#[derive(Debug, clap::Args)]
pub struct EndsArgs {
    /// Where it starts: geodetic degrees (a plane: X,Y of its CRS)
    #[arg(long, value_name = "LON,LAT")]
    from: PointArg,
    /// Where it ends
    #[arg(long, value_name = "LON,LAT")]
    to: PointArg,
}

/// The shortest way.
#[derive(serde::Serialize, ToSchema)]
pub struct Distance {
    /// Metres on the ellipsoid (a plane: straight, on the map), heights left out.
    distance_m: f64,
    /// Azimuth at the start, degrees clockwise from north (a plane: from its Y axis), -180 to 180.
    azimuth_from_deg: f64,
    /// Azimuth at the end, onwards.
    azimuth_to_deg: f64,
}

/// Length and azimuths of the geodesic between two points
#[utoipa::path(
    get,
    path = "/v1/planets/{name}/distance",
    params(At, Words<EndsArgs>),
    responses((status = 200, description = "Length and azimuths", body = Distance), Refused)
)]
pub async fn distance(At(served): At, Words(args): Words<EndsArgs>) -> Result<Json<Distance>, Refused> {
    Ok(Json(between(&served.planet(), args.from.0, args.to.0)?))
}

fn between(planet: &Planet, from: [f64; 2], to: [f64; 2]) -> Result<Distance, Fault> {
    let (distance_m, azimuth_from_deg, azimuth_to_deg) = match (planet.ellipsoid(), planet.metres_per_unit()) {
        (Some(ellipsoid), _) => {
            let ([lon, lat], [to_lon, to_lat]) = (on_globe(from)?, on_globe(to)?);
            let geodesic = Geodesic::new(ellipsoid.a_m, (ellipsoid.a_m - ellipsoid.b_m) / ellipsoid.a_m);
            let (distance_m, azimuth_from, azimuth_to, _arc) = geodesic.inverse(lat, lon, to_lat, to_lon);
            (distance_m, azimuth_from, azimuth_to)
        }
        (None, unit_m) => {
            let [x_m, y_m] = unit_m.unwrap_or([1.0; 2]);
            let (east_m, north_m) = ((to[0] - from[0]) * x_m, (to[1] - from[1]) * y_m);
            let azimuth = east_m.atan2(north_m).to_degrees();
            (east_m.hypot(north_m), azimuth, azimuth)
        }
    };
    if !distance_m.is_finite() {
        let what = format!("{},{} to {},{}", from[0], from[1], to[0], to[1]);
        return Err(Fault::new(Code::BadView, what, "both ends lie on the planet's map", "correct the coordinates"));
    }
    Ok(Distance { distance_m, azimuth_from_deg, azimuth_to_deg })
}

fn on_globe([lon, lat]: [f64; 2]) -> Result<[f64; 2], Fault> {
    match (-90.0..=90.0).contains(&lat) {
        // The remainder is exact, and a longitude of many turns is one of one.
        true => Ok([lon % 360.0, lat]),
        false => Err(off_map(false, format!("latitude {lat}"))),
    }
}
