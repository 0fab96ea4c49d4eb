//! HTTP: the page, scripts' questions, and the WebSocket that viewers attach by.

mod at;
mod attach;
mod off_thread;
mod page;
mod refused;
mod v1;
mod words;

use std::sync::Arc;

use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderMap, header};
use axum::routing::get;
use axum::{Extension, Router};
use utoipa::OpenApi as _;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::hub::Hub;

/// All routes.
pub fn router(hub: Arc<Hub>) -> Router {
    let (router, described) = OpenApiRouter::with_openapi(v1::openapi::Head::openapi())
        .routes(routes!(v1::planets::planets))
        .routes(routes!(v1::planets::planet))
        .routes(routes!(v1::render::render))
        .routes(routes!(v1::mesh::mesh))
        .routes(routes!(v1::height::height))
        .routes(routes!(v1::heights::heights))
        .routes(routes!(v1::distance::distance))
        .routes(routes!(v1::openapi::openapi))
        .split_for_parts();
    // What cannot be said as JSON is not in it.
    let text = v1::openapi::Text(described.to_json().unwrap_or_default().into());
    router
        .route("/", get(page::index))
        .route("/page/{name}", get(page::part))
        .route("/v1/attach", get(attach::attach))
        .fallback(refused::no_route)
        .method_not_allowed_fallback(refused::no_method)
        .layer(Extension(text))
        .layer(DefaultBodyLimit::max(v1::heights::MOST_BYTES))
        .with_state(hub)
}

/// The token of an `Authorization: Bearer` header.
fn token(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    value.strip_prefix("Bearer ").map(|token| token.trim().to_owned())
}
