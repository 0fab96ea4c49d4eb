//! Who may ask: pages of the daemon's own origin, by its own name, with its token.
//!
//! A daemon on a loopback address has no token, and any page that a browser on this machine shows can
//! send it requests. The browser names that page's origin, and it is refused. A page that makes its own
//! name point to 127.0.0.1 (DNS rebinding) is of the same origin, but under a name that is not ours.

use std::net::IpAddr;

use axum::extract::{Query, Request, State};
use axum::http::{HeaderMap, header};
use axum::middleware::Next;
use axum::response::Response;
use relief_protocol::error::{Code, Fault};

use super::attach::Token;
use super::refused::Refused;
use super::shared::Shared;

/// The token of an `Authorization: Bearer` header.
pub fn token(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    value.strip_prefix("Bearer ").map(|token| token.trim().to_owned())
}

/// Refuses pages of other origins and, where no token protects the daemon, other names for it.
pub async fn at_home(State(shared): State<Shared>, request: Request, next: Next) -> Result<Response, Refused> {
    let host = header_text(request.headers(), header::HOST)?;
    if let Some(host) = host.filter(|_| !shared.hub.has_token())
        && !is_this_machine(host)
    {
        return Err(Fault::new(
            Code::Origin,
            format!("a request to {host:?}"),
            "a daemon without a token answers as localhost or by a loopback address",
            "open it by such an address, or start it with --token-file",
        )
        .into());
    }
    if let Some(origin) = header_text(request.headers(), header::ORIGIN)?
        && !is_same(origin, host)
    {
        return Err(Fault::new(
            Code::Origin,
            format!("a page of {origin:?}"),
            "pages that ask the daemon are its own: their origin is the host that is asked",
            "open the daemon's page; a server in front of it passes the Host header on",
        )
        .into());
    }
    Ok(next.run(request).await)
}

/// Refuses who shows no token, where there is one.
pub async fn trusted(State(shared): State<Shared>, request: Request, next: Next) -> Result<Response, Refused> {
    let token = token(request.headers()).or_else(|| {
        let query = Query::<Token>::try_from_uri(request.uri()).ok()?;
        query.0.token
    });
    if !shared.hub.admits(token.as_deref()) {
        return Err(shared.hub.no_token(token.is_some()).into());
    }
    Ok(next.run(request).await)
}

/// Refuses new work while the daemon ends.
pub async fn running(State(shared): State<Shared>, request: Request, next: Next) -> Result<Response, Refused> {
    if shared.stop.begun() {
        let rule = "a daemon that ends takes no new work";
        return Err(Fault::new(Code::Busy, "the daemon is ending", rule, "ask again once it runs").into());
    }
    Ok(next.run(request).await)
}

/// Refuses more work than there is room for.
pub async fn limited(State(shared): State<Shared>, request: Request, next: Next) -> Result<Response, Refused> {
    let Ok(_permit) = shared.room.clone().try_acquire_owned() else {
        return Err(Fault::new(
            Code::Busy,
            "as many requests in work as the daemon takes",
            "a daemon works on as many requests as --max-requests allows",
            "ask again in a second",
        )
        .into());
    };
    let _counted = shared.hub.meters.at_work();
    Ok(next.run(request).await)
}

fn header_text(headers: &HeaderMap, name: header::HeaderName) -> Result<Option<&str>, Fault> {
    let text = headers.get(&name).map(|value| value.to_str());
    text.transpose().map_err(|_| {
        Fault::new(Code::Malformed, format!("a {name} header that is no text"), "headers are ASCII", "leave it out")
    })
}

/// Whether a host is a name of this machine's loopback addresses.
fn is_this_machine(host: &str) -> bool {
    let name = match host.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        Some((ip, _)) => ip,
        None => host.split_once(':').map_or(host, |(name, _)| name),
    };
    let name = name.to_ascii_lowercase();
    let loopback = name.parse::<IpAddr>().is_ok_and(|ip| ip.to_canonical().is_loopback());
    loopback || name == "localhost" || name.ends_with(".localhost")
}

/// Whether an origin is the host that was asked.
fn is_same(origin: &str, host: Option<&str>) -> bool {
    let Some((scheme, rest)) = origin.split_once("://") else { return false };
    matches!(scheme, "http" | "https") && host.is_some_and(|host| host.eq_ignore_ascii_case(rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_this_machine() {
        for own in ["localhost", "LOCALHOST:80", "127.0.0.1:7878", "127.1.2.3", "[::1]:7878", "a.localhost:1"] {
            assert!(is_this_machine(own), "{own}");
        }
        for other in ["", "example.org", "127.0.0.1.example.org:7878", "localhost.example.org", "[::2]", "192.168.0.1"]
        {
            assert!(!is_this_machine(other), "{other}");
        }
    }

    #[test]
    fn origins_are_the_host_that_was_asked() {
        assert!(is_same("http://127.0.0.1:7878", Some("127.0.0.1:7878")));
        assert!(is_same("https://Relief.example.org", Some("relief.example.org")));
        let others =
            ["null", "", "http://127.0.0.1", "http://127.0.0.1:78780", "http://evil.example", "file://127.0.0.1:7878"];
        for other in others {
            assert!(!is_same(other, Some("127.0.0.1:7878")), "{other}");
        }
        assert!(!is_same("http://127.0.0.1:7878", None));
    }
}
