//! `GET /v1/openapi.json`: all of this, described from the handlers and the types themselves.

use std::sync::Arc;

use axum::Extension;
use axum::http::header;
use axum::response::{IntoResponse as _, Response};
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityScheme};
use utoipa::{Modify, OpenApi};

use crate::serve::http::refused::Problem;

/// What the handlers do not say themselves.
#[derive(OpenApi)]
#[openapi(
    info(title = "reliefd", description = "Frames, meshes, shadows and heights of planet-scale terrain"),
    components(schemas(Problem)),
    modifiers(&Token),
    security(("token" = []))
)]
pub struct Head;

/// `--token-file`.
struct Token;

impl Modify for Token {
    fn modify(&self, openapi: &mut utoipa::openapi::OpenApi) {
        let bearer = HttpBuilder::new()
            .scheme(HttpAuthScheme::Bearer)
            .description(Some("Where the daemon has a token; ?token=TOKEN does as well"))
            .build();
        openapi.components.get_or_insert_default().add_security_scheme("token", SecurityScheme::Http(bearer));
    }
}

/// The description as text.
#[derive(Clone)]
pub struct Text(pub Arc<str>);

/// This description
#[utoipa::path(get, path = "/v1/openapi.json", responses((status = 200, description = "OpenAPI 3.1", content_type = "application/json", body = serde_json::Value)))]
pub async fn openapi(Extension(Text(text)): Extension<Text>) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], text.to_string()).into_response()
}
