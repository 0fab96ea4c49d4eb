//! Every request in the figures and in the log.

use std::sync::Arc;
use std::time::Instant;

use axum::body::HttpBody as _;
use axum::extract::{MatchedPath, Request, State};
use axum::middleware::Next;
use axum::response::Response;
use relief_protocol::error::Code;

use crate::serve::hub::Hub;

/// Counts a request and what became of it. Queries are not logged: they may hold the token.
pub async fn measured(State(hub): State<Arc<Hub>>, request: Request, next: Next) -> Response {
    let began = Instant::now();
    let route = request.extensions().get::<MatchedPath>().map_or("none", MatchedPath::as_str).to_owned();
    let (method, path) = (request.method().clone(), request.uri().path().to_owned());
    let response = next.run(request).await;
    let (status, took) = (response.status().as_u16(), began.elapsed());
    let code = response.extensions().get::<Code>();
    hub.meters.answered(&route, status, took, response.body().size_hint().exact().unwrap_or(0));
    if let Some(&code) = code {
        hub.meters.fault(code);
        tracing::info!(%method, path, status, ?code, ms = took.as_millis() as u64, "refused");
    } else {
        tracing::debug!(%method, path, status, ms = took.as_millis() as u64, "answered");
    }
    response
}
