//! `GET /v1/planets/{name}/render`: a picture, as `reliefd render` makes it.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, HeaderValue, header};
use axum::response::{IntoResponse as _, Response};
use relief_protocol::payload::{Format, Stats};
use relief_protocol::to_server::{Frame, FrameFormat};
use utoipa::ToSchema;

use super::WaitArgs;
use crate::serve::ask::view_of;
use crate::serve::engine::{Once, Picture};
use crate::serve::http::at::At;
use crate::serve::http::off_thread::off_thread;
use crate::serve::http::refused::Refused;
use crate::serve::http::words::Words;
use crate::serve::hub::{Hub, Served};
use crate::serve::session::pack::frame_bytes;
use crate::view_args::ViewArgs;

/// A picture that is asked for.
#[derive(Debug, clap::Args)]
pub struct RenderArgs {
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    wait: WaitArgs,
    /// How it is packed; without it the Accept header decides, and else it is a PNG
    #[arg(long, value_enum)]
    format: Option<PictureFormat>,
    /// Quality of a JPEG, 1 to 100
    #[arg(long, value_name = "Q", default_value_t = 80, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Answer with the picture's figures as JSON instead of the picture
    #[arg(long)]
    stats: bool,
}

/// How pictures are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PictureFormat {
    /// Lossless
    Png,
    /// Smaller
    Jpeg,
}

/// Figures of a picture.
#[derive(serde::Serialize, ToSchema)]
pub struct Figures {
    /// False when tiles were still missing after the wait: coarser ones stand in.
    complete: bool,
    /// Where the sun stood: sub-solar longitude and latitude (a plane: azimuth and elevation), degrees.
    sun: [f64; 2],
    /// What it cost.
    stats: Stats,
}

/// A picture: adaptive relief, shaded and in the sun's light
///
/// Headers of a picture: X-Relief-Complete (false when tiles were still missing after the wait),
/// X-Relief-Triangles, X-Relief-Tiles-Missing, X-Relief-Holes, X-Relief-Draw-Ms, X-Relief-Wait-Ms,
/// X-Relief-Sun.
#[utoipa::path(
    get,
    path = "/v1/planets/{name}/render",
    params(At, Words<RenderArgs>),
    responses(
        (status = 200, description = "The picture, or its figures", content(
            (Vec<u8> = "image/png"),
            (Vec<u8> = "image/jpeg"),
            (Figures = "application/json"),
        )),
        Refused,
    )
)]
pub async fn render(
    State(hub): State<Arc<Hub>>,
    At(served): At,
    headers: HeaderMap,
    Words(args): Words<RenderArgs>,
) -> Result<Response, Refused> {
    let picture = drawn(&hub, &served, &args.view, &args.wait, false).await?;
    if args.stats {
        let Picture { complete, sun_deg: sun, ref stats, .. } = picture;
        return Ok(Json(Figures { complete, sun, stats: stats.clone() }).into_response());
    }
    let figures = figures(&picture);
    let format = args.format.unwrap_or_else(|| accepted(&headers));
    let format = match format {
        PictureFormat::Png => FrameFormat::Png,
        PictureFormat::Jpeg => FrameFormat::Jpeg,
    };
    let frame = Frame { format, quality: args.quality };
    let (packed, bytes) = off_thread(move |_| Ok(frame_bytes(&picture.frame, frame))).await?;
    let kind = if packed == Format::Jpeg { "image/jpeg" } else { "image/png" };
    Ok(([(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, "no-cache")], figures, bytes).into_response())
}

/// A picture of a view, once it is complete or the wait is over.
pub async fn drawn(
    hub: &Hub,
    served: &Served,
    view: &ViewArgs,
    wait: &WaitArgs,
    mesh: bool,
) -> Result<Picture, Refused> {
    let what = view_of(view);
    // What no planet can show need not wait for its turn.
    what.check()?;
    let once = Once { what, mesh, places: false, wait: wait.time() };
    Ok(served.engine.draw_once(hub.client(), once).await?)
}

/// A picture's figures as headers.
pub fn figures(picture: &Picture) -> HeaderMap {
    let stats = &picture.stats;
    let [x, y] = picture.sun_deg;
    let headers = [
        ("x-relief-complete", picture.complete.to_string()),
        ("x-relief-triangles", stats.triangles.to_string()),
        ("x-relief-tiles-missing", stats.tiles_missing.to_string()),
        ("x-relief-holes", stats.holes.to_string()),
        ("x-relief-draw-ms", stats.draw_ms.to_string()),
        ("x-relief-wait-ms", stats.wait_ms.to_string()),
        ("x-relief-sun", format!("{x:.6},{y:.6}")),
    ];
    let header = |(name, value): (&'static str, String)| {
        Some((HeaderName::from_static(name), HeaderValue::try_from(value).ok()?))
    };
    headers.into_iter().filter_map(header).collect()
}

/// JPEG where it is wanted more than PNG.
fn accepted(headers: &HeaderMap) -> PictureFormat {
    let accept = headers.get(header::ACCEPT).and_then(|value| value.to_str().ok()).unwrap_or_default();
    let wanted = |kind: &str| {
        let entries = accept.split(',').map(|entry| entry.split(';').map(str::trim));
        entries
            .filter_map(|mut entry| {
                let exact = match entry.next()? {
                    "*/*" | "image/*" => false,
                    named if named == kind => true,
                    _ => return None,
                };
                let q = entry.find_map(|part| part.strip_prefix("q=")?.parse::<f32>().ok()).unwrap_or(1.0);
                Some((exact, q))
            })
            // The exact name is worth more than a wildcard.
            .fold((false, 0.0f32), |best, entry| match (entry.0, best.0) {
                (true, false) => entry,
                (exact, known) if exact == known => (exact, best.1.max(entry.1)),
                _ => best,
            })
            .1
    };
    if wanted("image/jpeg") > wanted("image/png") { PictureFormat::Jpeg } else { PictureFormat::Png }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wanted_more_is_sent() {
        let of = |accept: &'static str| {
            accepted(&HeaderMap::from_iter([(header::ACCEPT, HeaderValue::from_static(accept))]))
        };
        for accept in
            ["", "*/*", "image/png", "image/jpeg, image/png", "text/html,image/*;q=0.8", "image/jpeg;q=0.5,*/*"]
        {
            assert_eq!(of(accept), PictureFormat::Png, "{accept}");
        }
        for accept in
            ["image/jpeg", "image/png;q=0.5, image/jpeg;q=0.9", "image/jpeg,*/*;q=0.1", "image/*,image/png;q=0"]
        {
            assert_eq!(of(accept), PictureFormat::Jpeg, "{accept}");
        }
    }
}
