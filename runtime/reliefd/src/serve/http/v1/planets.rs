//! `GET /v1/planets`, `GET /v1/planets/{name}`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use relief_protocol::to_viewer::Planet;

use crate::serve::http::at::At;
use crate::serve::http::refused::Refused;
use crate::serve::hub::Hub;

/// All planets that are served
#[utoipa::path(get, path = "/v1/planets", responses((status = 200, description = "All planets, by name", body = Vec<Planet>), Refused))]
pub async fn planets(State(hub): State<Arc<Hub>>) -> Json<Vec<Planet>> {
    Json(hub.planets())
}

/// One planet, as in a viewer's welcome
#[utoipa::path(get, path = "/v1/planets/{name}", params(At), responses((status = 200, description = "The planet", body = Planet), Refused))]
pub async fn planet(At(served): At) -> Json<Planet> {
    Json(served.described())
}
