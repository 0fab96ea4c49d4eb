//! `POST /v1/planets/{name}/heights`: many points at once.

use std::time::Duration;

use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::extract::{FromRequest as _, Request};
use relief_protocol::error::{Code, Fault};
use utoipa::ToSchema;

use crate::serve::heights::samples;
use crate::serve::http::at::At;
use crate::serve::http::off_thread::off_thread;
use crate::serve::http::refused::Refused;

/// Most points of a request.
const MOST_POINTS: usize = 100_000;
/// Most bytes of a request: two numbers of full length a point.
pub const MOST_BYTES: usize = 8 << 20;
/// Time for a request's points to arrive.
const BODY: Duration = Duration::from_secs(30);

/// Points of a level.
#[derive(serde::Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Points {
    /// Longitude and latitude, degrees (a plane: X and Y of its CRS); at most 100 000.
    points: Vec<[f64; 2]>,
    /// Level of the nodes; 0 is the finest.
    #[serde(default)]
    level: u32,
}

/// Heights in the order of the points.
#[derive(serde::Serialize, ToSchema)]
pub struct Heights {
    /// Level of the nodes around them.
    level: u32,
    /// Metres.
    heights_m: Vec<f64>,
    /// True where a node around the point holds no measurement.
    filled: Vec<bool>,
}

/// Heights at many points
#[utoipa::path(
    post,
    path = "/v1/planets/{name}/heights",
    params(At),
    request_body = Points,
    responses((status = 200, description = "Heights in the order of the points", body = Heights), Refused)
)]
pub async fn heights(At(served): At, request: Request) -> Result<Json<Heights>, Refused> {
    // Who sends slowly holds a place among the requests in work.
    let Ok(body) = tokio::time::timeout(BODY, Json::<Points>::from_request(request, &())).await else {
        let rule = format!("a request arrives within {} s", BODY.as_secs());
        return Err(Fault::new(Code::Timeout, "points that do not arrive", rule, "send them in parts").into());
    };
    let Json(Points { points, level }) = body.map_err(|error| unread(&error))?;
    if points.len() > MOST_POINTS {
        let rule = format!("a request has at most {MOST_POINTS} points");
        return Err(Fault::new(Code::TooLarge, format!("{} points", points.len()), rule, "send them in parts").into());
    }
    let planet = served.planet();
    let samples = off_thread(move |asker| samples(&planet, &points, level, || asker.waits())).await?;
    let (heights_m, filled) = samples.into_iter().map(|sample| (sample.height_m, sample.filled)).unzip();
    Ok(Json(Heights { level, heights_m, filled }))
}

fn unread(error: &JsonRejection) -> Fault {
    let code = match error.status() {
        axum::http::StatusCode::PAYLOAD_TOO_LARGE => Code::TooLarge,
        _ => Code::Malformed,
    };
    Fault::new(
        code,
        error.body_text(),
        format!("a request is application/json, at most {MOST_BYTES} bytes"),
        "send {\"points\":[[LON,LAT],...],\"level\":0}",
    )
}
