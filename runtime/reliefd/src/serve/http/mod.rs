//! HTTP: the page, scripts' questions, and the WebSocket that viewers attach by.

mod attach;
mod page;

use std::sync::Arc;

use axum::Router;
use axum::http::{HeaderMap, header};
use axum::routing::get;

use super::hub::Hub;

/// All routes.
pub fn router(hub: Arc<Hub>) -> Router {
    Router::new()
        .route("/", get(page::index))
        .route("/page/{name}", get(page::part))
        .route("/v1/attach", get(attach::attach))
        .with_state(hub)
}

/// The token of an `Authorization: Bearer` header.
fn token(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    value.strip_prefix("Bearer ").map(|token| token.trim().to_owned())
}
