//! The page, from the program itself.

use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use rust_embed::RustEmbed;

/// The files of `runtime/web`.
#[derive(RustEmbed)]
#[folder = "../web"]
struct Files;

/// The page.
pub async fn index(headers: HeaderMap) -> Response {
    answer("index.html", &headers).unwrap_or_else(|| StatusCode::NOT_FOUND.into_response())
}

/// What it is made of.
pub async fn part(Path(name): Path<String>, uri: Uri, headers: HeaderMap) -> Response {
    match answer(&name, &headers) {
        Some(answer) => answer,
        None => super::refused::no_route(uri).await.into_response(),
    }
}

fn answer(name: &str, headers: &HeaderMap) -> Option<Response> {
    let file = Files::get(name)?;
    let tag = format!("\"{}\"", blake3::hash(&file.data).to_hex());
    // A new daemon may bring a new page: browsers ask each time, and get it again only then.
    let known = headers.get(header::IF_NONE_MATCH).is_some_and(|given| given.as_bytes() == tag.as_bytes());
    let head = [
        (header::CONTENT_TYPE, file.metadata.mimetype().to_owned()),
        (header::CACHE_CONTROL, "no-cache".to_owned()),
        (header::ETAG, tag),
    ];
    Some(match known {
        true => (StatusCode::NOT_MODIFIED, head).into_response(),
        false => (head, file.data).into_response(),
    })
}
