//! HTTP: the page, scripts' questions, and the WebSocket that viewers attach by.

mod at;
mod attach;
pub mod connections;
mod guard;
mod measured;
mod off_thread;
mod ops;
mod page;
mod refused;
pub mod shared;
mod v1;
mod words;

use std::sync::Arc;

use axum::extract::DefaultBodyLimit;
use axum::middleware::from_fn_with_state;
use axum::routing::get;
use axum::{Extension, Router};
use utoipa::OpenApi as _;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use guard::token;
use shared::Shared;

/// All routes. Whatever `routes!` names is in the description at `/v1/openapi.json`; the page is not.
pub fn router(shared: Shared) -> Router {
    let work = OpenApiRouter::new()
        .routes(routes!(v1::render::render))
        .routes(routes!(v1::mesh::mesh))
        .routes(routes!(v1::shadow::shadow))
        .routes(routes!(v1::height::height))
        .routes(routes!(v1::heights::heights))
        .routes(routes!(v1::distance::distance))
        .layer(from_fn_with_state(shared.clone(), guard::limited))
        .layer(DefaultBodyLimit::max(v1::heights::MOST_BYTES));
    // It looks for the token itself, which may come with the hello.
    let attach = OpenApiRouter::new()
        .routes(routes!(v1::attach::attach))
        .layer(from_fn_with_state(shared.clone(), guard::running));
    let with_token = OpenApiRouter::with_openapi(v1::openapi::Head::openapi())
        .routes(routes!(v1::planets::planets))
        .routes(routes!(v1::planets::planet))
        .routes(routes!(v1::openapi::openapi))
        .merge(work)
        .layer(from_fn_with_state(shared.clone(), guard::running));
    let (router, described) = with_token
        .routes(routes!(ops::metrics::metrics))
        .layer(from_fn_with_state(shared.clone(), guard::trusted))
        .merge(attach)
        .routes(routes!(ops::health::health))
        .split_for_parts();
    // Nothing in it is no JSON.
    let text = v1::openapi::Text(described.to_json().unwrap_or_default().into());
    router
        .route("/", get(page::index))
        .route("/page/{name}", get(page::part))
        .fallback(refused::no_route)
        .method_not_allowed_fallback(refused::no_method)
        .layer(Extension(text))
        .layer(from_fn_with_state(shared.clone(), guard::at_home))
        .layer(from_fn_with_state(Arc::clone(&shared.hub), measured::measured))
        .with_state(shared)
}
