//! `GET /metrics`.

use std::sync::Arc;

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse as _, Response};

use crate::serve::http::refused::Refused;
use crate::serve::hub::Hub;
use crate::serve::meters::Census;

/// Figures for Prometheus, as OpenMetrics text
#[utoipa::path(
    get,
    path = "/metrics",
    responses(
        (status = 200, description = "OpenMetrics 1.0", body = String,
            content_type = "application/openmetrics-text; version=1.0.0; charset=utf-8"),
        Refused,
    )
)]
pub async fn metrics(State(hub): State<Arc<Hub>>) -> Response {
    let census = hub.all().map(|served| Census {
        planet: served.name.clone(),
        cameras: served.engine.load(),
        cache: served.planet().tiles().hits_and_misses(),
    });
    let text = hub.meters.text(census);
    ([(header::CONTENT_TYPE, "application/openmetrics-text; version=1.0.0; charset=utf-8")], text).into_response()
}
