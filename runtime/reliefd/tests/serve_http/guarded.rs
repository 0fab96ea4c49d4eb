//! Who may ask: the token, other sites' pages, other names; and daemons that refuse to start.

use std::os::unix::fs::PermissionsExt as _;

use crate::client::ask;
use crate::daemon::{Daemon, Files, run};

const TOKEN: &str = "0123456789abcdef0123456789abcdef";

fn with_token(files: &Files) -> Daemon {
    let path = files.path("token");
    std::fs::write(&path, format!("{TOKEN}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
    Daemon::start(files, "--token-file DIR/token")
}

#[test]
fn a_token_is_asked_for_but_not_by_the_page() {
    let files = Files::new();
    let daemon = with_token(&files);
    for target in ["/v1/planets", "/v1/planets/globe/height?lon=1&lat=1", "/v1/openapi.json", "/metrics"] {
        for lines in [&[][..], &["Authorization: Bearer wrong"], &["Authorization: Basic MDE="]] {
            let answer = ask(daemon.address(), "GET", target, lines, b"");
            assert_eq!(answer.header("www-authenticate"), Some("Bearer"));
            assert_eq!(answer.json(401)["code"], "token", "{target}");
        }
        let bearer = format!("Authorization: Bearer {TOKEN}");
        ask(daemon.address(), "GET", target, &[&bearer], b"").good();
        let sign = if target.contains('?') { '&' } else { '?' };
        daemon.get(&format!("{target}{sign}token={TOKEN}")).good();
        assert_eq!(daemon.get(&format!("{target}{sign}token={TOKEN}x")).status, 401);
    }
    for open in ["/", "/healthz"] {
        daemon.get(open).good();
    }
    daemon.signal("TERM");
    let (code, log) = daemon.ended();
    assert!(code == 0 && !log.contains(TOKEN), "{log}");
}

#[test]
fn other_sites_pages_are_refused() {
    let files = Files::new();
    let daemon = Daemon::start(&files, "");
    let upgrade = ["Upgrade: websocket", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="];
    let own = format!("Origin: http://{}", daemon.address());
    let port = daemon.address().split_once(':').unwrap().1;
    for origin in ["null", "http://evil.example", &format!("http://evil.example:{port}"), "http://127.0.0.1:1"] {
        let origin = format!("Origin: {origin}");
        let lines = [&upgrade[..], &[&origin]].concat();
        for target in ["/v1/attach", "/v1/planets", "/healthz"] {
            let answer = ask(daemon.address(), "GET", target, &lines, b"");
            assert!(answer.headers.iter().all(|(name, _)| !name.starts_with("access-control")), "{answer:?}");
            assert_eq!(answer.json(403)["code"], "origin", "{origin} {target}");
        }
    }
    ask(daemon.address(), "GET", "/v1/planets", &[&own], b"").good();
    let local = format!("Host: localhost:{port}");
    ask(daemon.address(), "GET", "/v1/planets", &[&local, &format!("Origin: http://localhost:{port}")], b"").good();
}

/// A page whose name points to 127.0.0.1 is of the same origin; its name gives it away.
#[test]
fn other_names_are_refused_unless_a_token_protects() {
    let files = Files::new();
    let lines = ["Host: rebound.example:7878", "Origin: http://rebound.example:7878"];
    let daemon = Daemon::start(&files, "");
    for target in ["/", "/v1/planets", "/v1/attach"] {
        assert_eq!(ask(daemon.address(), "GET", target, &lines, b"").json(403)["code"], "origin", "{target}");
    }
    let guarded = with_token(&files);
    let bearer = format!("Authorization: Bearer {TOKEN}");
    ask(guarded.address(), "GET", "/v1/planets", &[lines[0], lines[1], &bearer], b"").good();
}

#[test]
fn what_cannot_start_says_why() {
    let files = Files::new();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    std::fs::create_dir(files.path("other")).unwrap();
    std::fs::copy(files.path("globe.relief"), files.path("other/globe.relief")).unwrap();
    std::fs::write(files.path("blank"), "\n").unwrap();
    for (words, says) in [
        ("DIR/globe.relief --listen 0.0.0.0:0", "--token-file"),
        ("DIR/globe.relief --listen [::]:0", "TLS in front"),
        ("DIR/globe.relief --listen elsewhere", "IP:PORT"),
        (&format!("DIR/globe.relief --listen 127.0.0.1:{port}"), "where nobody else does"),
        ("DIR/globe.relief --listen auto --token-file DIR/blank", "an empty first line"),
        ("DIR/globe.relief --listen auto --token-file DIR/none", "cannot read the token"),
        ("DIR/globe.relief DIR/other/globe.relief --listen auto", "are both globe"),
        ("DIR/none.relief --listen auto", "none.relief"),
        ("DIR/globe.relief --memory-limit lots", "--memory-limit"),
        ("DIR/globe.relief --time-budget nan", "--time-budget"),
        ("DIR/globe.relief --max-viewers 0", "--max-viewers"),
        ("--listen auto", "FILE"),
    ] {
        let (code, log) = run(&files, &format!("serve --backend cpu {words}"));
        assert!(code == 2 && log.contains(says), "{words}: {code} {log}");
    }
}

#[test]
fn others_may_be_served_with_a_token() {
    let files = Files::new();
    std::fs::write(files.path("token"), "short").unwrap();
    std::fs::set_permissions(files.path("token"), std::fs::Permissions::from_mode(0o644)).unwrap();
    let words = "serve DIR/globe.relief --backend cpu --listen 0.0.0.0:0 --token-file DIR/token";
    let daemon = Daemon::spawn(files.command(words));
    assert!(daemon.url.starts_with("http://127.0.0.1:"), "{}", daemon.url);
    daemon.get("/v1/planets?token=short").good();
    daemon.signal("TERM");
    let (code, log) = daemon.ended();
    assert_eq!(code, 0);
    assert!(log.contains("only 5 signs") && log.contains("others may read the token"), "{log}");
}
