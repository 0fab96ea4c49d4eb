//! Refusals: a fault as an answer, its status, and what the routes themselves refuse.

use std::collections::BTreeMap;

use axum::Json;
use axum::http::{HeaderValue, Method, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use relief_protocol::error::{Code, Fault};
use utoipa::openapi::{ContentBuilder, Ref, RefOr, ResponseBuilder};
use utoipa::{IntoResponses, ToSchema};

/// Seconds after which who found the daemon busy may ask again.
const AGAIN_S: HeaderValue = HeaderValue::from_static("1");

/// What is wrong with a request.
#[derive(serde::Serialize, ToSchema)]
pub struct Problem {
    /// Its kind; a stable word, for programs.
    code: Code,
    /// The value that was found.
    what: String,
    /// What it must satisfy.
    rule: String,
    /// What to do about it.
    remedy: String,
}

/// A request that is not answered.
#[derive(Debug)]
pub struct Refused {
    fault: Box<Fault>,
    status: StatusCode,
}

impl From<Fault> for Refused {
    fn from(fault: Fault) -> Self {
        let status = status(fault.code);
        Self { fault: Box::new(fault), status }
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        let Self { fault, status } = self;
        let Fault { code, what, rule, remedy, .. } = *fault;
        let mut response = (status, Json(Problem { code, what, rule, remedy })).into_response();
        // For whoever counts faults.
        response.extensions_mut().insert(code);
        let headers = response.headers_mut();
        if code == Code::Busy {
            headers.insert(header::RETRY_AFTER, AGAIN_S);
        }
        if code == Code::Token {
            headers.insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        response
    }
}

impl IntoResponses for Refused {
    fn responses() -> BTreeMap<String, RefOr<utoipa::openapi::Response>> {
        let content = ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem"))).build();
        let response = ResponseBuilder::new()
            .description("Refused: a problem's code, value, rule and remedy")
            .content("application/json", content)
            .build();
        BTreeMap::from([("default".to_owned(), response.into())])
    }
}

/// The one place where a kind of fault gets its status.
fn status(code: Code) -> StatusCode {
    match code {
        Code::Malformed | Code::BadView | Code::Version => StatusCode::BAD_REQUEST,
        Code::Token => StatusCode::UNAUTHORIZED,
        Code::Origin => StatusCode::FORBIDDEN,
        Code::Unknown => StatusCode::NOT_FOUND,
        Code::Timeout => StatusCode::REQUEST_TIMEOUT,
        Code::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
        Code::Busy | Code::Device => StatusCode::SERVICE_UNAVAILABLE,
        Code::Damaged | Code::Internal => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

/// No such route.
pub async fn no_route(uri: Uri) -> Refused {
    Fault::new(
        Code::Unknown,
        format!("the path {}", uri.path()),
        "a path is one of those in /v1/openapi.json",
        "look there",
    )
    .into()
}

/// No such method of a route.
pub async fn no_method(method: Method, uri: Uri) -> Refused {
    let what = format!("{method} {}", uri.path());
    let fault = Fault::new(
        Code::Malformed,
        what,
        "a path is asked by the methods that /v1/openapi.json names",
        "use one of those in the Allow header",
    );
    Refused { fault: Box::new(fault), status: StatusCode::METHOD_NOT_ALLOWED }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_busy_say_when_to_come_again() {
        let answer = |code| Refused::from(Fault::new(code, "", "", "")).into_response();
        let busy = answer(Code::Busy);
        assert_eq!(
            (busy.status(), busy.headers().get(header::RETRY_AFTER)),
            (StatusCode::SERVICE_UNAVAILABLE, Some(&AGAIN_S))
        );
        let unknown = answer(Code::Unknown);
        assert_eq!((unknown.status(), unknown.headers().get(header::RETRY_AFTER)), (StatusCode::NOT_FOUND, None));
    }
}
