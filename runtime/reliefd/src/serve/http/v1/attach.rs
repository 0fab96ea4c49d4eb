//! `GET /v1/attach`, as OpenAPI describes it; PROTOCOL.md says the rest.

use std::sync::Arc;

use axum::extract::rejection::QueryRejection;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::{Query, State};
use axum::http::HeaderMap;
use axum::response::Response;
use relief_protocol::error::{Code, Fault};

use crate::serve::http::attach::{self, Token};
use crate::serve::http::refused::Refused;
use crate::serve::hub::Hub;

/// Viewers attach by a WebSocket: runtime/PROTOCOL.md
#[utoipa::path(
    get,
    path = "/v1/attach",
    responses((status = 101, description = "A WebSocket"), Refused),
    security((), ("token" = []))
)]
pub async fn attach(
    hub: State<Arc<Hub>>,
    token: Result<Query<Token>, QueryRejection>,
    headers: HeaderMap,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Refused> {
    let token = token.map_err(|error| malformed(error.body_text()))?;
    let upgrade = upgrade.map_err(|error| malformed(error.body_text()))?;
    Ok(attach::attach(hub, token, headers, upgrade).await)
}

fn malformed(what: String) -> Fault {
    Fault::new(Code::Malformed, what, "a viewer opens a WebSocket, version 13", "see runtime/PROTOCOL.md")
}
