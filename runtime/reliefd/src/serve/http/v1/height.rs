//! `GET /v1/planets/{name}/height`: what `relief-bake probe` says of a point.

use axum::Json;
use relief_protocol::error::{Code, Fault};
use relief_runtime::planet::Planet;
use utoipa::ToSchema;

use crate::serve::heights::sample;
use crate::serve::http::at::At;
use crate::serve::http::off_thread::off_thread;
use crate::serve::http::refused::Refused;
use crate::serve::http::words::Words;

/// A point and a level.
#[derive(Debug, clap::Args)]
pub struct PointArgs {
    /// Longitude, degrees, any turn (globes)
    #[arg(long, value_name = "DEG")]
    lon: Option<f64>,
    /// Geodetic latitude, degrees (globes)
    #[arg(long, value_name = "DEG")]
    lat: Option<f64>,
    /// X of the CRS (planes)
    #[arg(long, value_name = "X")]
    x: Option<f64>,
    /// Y of the CRS (planes)
    #[arg(long, value_name = "Y")]
    y: Option<f64>,
    /// Level of the nodes; 0 is the finest
    #[arg(long, value_name = "K", default_value_t = 0)]
    level: u32,
}

/// What is known of a point.
#[derive(serde::Serialize, ToSchema)]
pub struct Height {
    /// Metres along the normal; between nodes bilinear.
    height_m: f64,
    /// Level of the nodes around it.
    level: u32,
    /// True where one of them holds no measurement.
    filled: bool,
    /// Least and greatest height of the finest level in the cells around it, metres.
    bounds_m: [f64; 2],
    /// Earth-centred, Earth-fixed (any globe), metres; not for planes.
    #[serde(skip_serializing_if = "Option::is_none")]
    ecef_m: Option<[f64; 3]>,
}

/// Height, bounds and fill at a point
#[utoipa::path(
    get,
    path = "/v1/planets/{name}/height",
    params(At, Words<PointArgs>),
    responses((status = 200, description = "The height and what is known of it", body = Height), Refused)
)]
pub async fn height(At(served): At, Words(args): Words<PointArgs>) -> Result<Json<Height>, Refused> {
    let planet = served.planet();
    let [x, y] = args.point(planet.grid().plane)?;
    Ok(Json(off_thread(move |_| of(&planet, [x, y], args.level)).await?))
}

fn of(planet: &Planet, [x, y]: [f64; 2], level: u32) -> Result<Height, Fault> {
    let sample = sample(planet, [x, y], level)?;
    let ecef_m = planet.ellipsoid().map(|ellipsoid| ellipsoid.ecef_from_deg_m(x, y, sample.height_m));
    Ok(Height { height_m: sample.height_m, level, filled: sample.filled, bounds_m: sample.bounds_m, ecef_m })
}

impl PointArgs {
    fn point(&self, plane: bool) -> Result<[f64; 2], Fault> {
        let (globes, planes) = ((self.lon, self.lat), (self.x, self.y));
        let (point, other, rule, remedy) = match plane {
            false => (globes, planes, "a point of a globe is lon and lat, in degrees", "give lon=...&lat=..."),
            true => (planes, globes, "a point of a plane is x and y of its CRS", "give x=...&y=..."),
        };
        match (point, other) {
            ((Some(x), Some(y)), (None, None)) => Ok([x, y]),
            _ => {
                let names = [("lon", self.lon), ("lat", self.lat), ("x", self.x), ("y", self.y)];
                let given: Vec<&str> =
                    names.iter().filter(|(_, value)| value.is_some()).map(|&(name, _)| name).collect();
                let what = match given.as_slice() {
                    [] => "a height without a point".to_owned(),
                    given => format!("a point by {} alone", given.join(", ")),
                };
                Err(Fault::new(Code::BadView, what, rule, remedy))
            }
        }
    }
}
