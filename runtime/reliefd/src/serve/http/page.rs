//! The page, from the program itself.

use axum::extract::Path;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

/// A file of the page: its name, its type and its bytes.
type Part = (&'static str, &'static str, &'static str);

const INDEX: &str = include_str!("../../../../web/index.html");

/// All files but the first.
const PARTS: &[Part] = &[("app.js", "text/javascript", include_str!("../../../../web/app.js"))];

/// The page.
pub async fn index() -> Response {
    answer("text/html; charset=utf-8", INDEX)
}

/// What it is made of.
pub async fn part(Path(name): Path<String>) -> Response {
    match PARTS.iter().find(|(known, ..)| *known == name) {
        Some((_, kind, text)) => answer(kind, text),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

fn answer(kind: &'static str, text: &'static str) -> Response {
    // A new daemon may bring a new page.
    ([(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, "no-cache")], text).into_response()
}
