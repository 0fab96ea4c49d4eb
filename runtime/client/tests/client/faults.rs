//! What ends an attachment.

use std::io::{Read, Write};
use std::net::TcpListener;
use std::time::Duration;

use relief_client::{AttachError, Attached, Event, Options};
use relief_protocol::error::{Code, Fault};
use relief_protocol::to_viewer::{ToViewer, Welcome};

use crate::fake::{Peer, both, local, options, web, welcome};

/// What attaching ends with, over both ways.
fn refusals(daemon: fn(&mut dyn Peer)) -> Vec<AttachError> {
    let brief = Options { timeout: Duration::from_millis(300), ..options() };
    let parts = [web(move |peer| daemon(peer)), local(move |peer| daemon(peer))];
    parts
        .map(|(address, thread)| {
            let error = Attached::to(&address, &brief).err().unwrap();
            thread.join().unwrap();
            error
        })
        .into()
}

#[test]
fn a_daemon_may_refuse_be_of_another_version_or_say_nothing() {
    let fault = Fault::new(Code::Token, "no token", "a token is shown", "show it").fatal();
    let told = fault.clone();
    for error in refusals(|peer| {
        peer.hear();
        peer.say(&ToViewer::Error(Fault::new(Code::Token, "no token", "a token is shown", "show it").fatal()));
    }) {
        assert!(matches!(&error, AttachError::Fault(fault) if *fault == told), "{error}");
    }
    for error in refusals(|peer| peer.say(&ToViewer::Welcome(Welcome { version: 2, ..welcome() }))) {
        assert!(matches!(&error, AttachError::Foreign(what) if what.contains("version 2")), "{error}");
    }
    for error in refusals(|peer| peer.raw("{}")) {
        assert!(matches!(error, AttachError::Foreign(_)), "{error}");
    }
    for error in refusals(|_| ()) {
        assert!(matches!(error, AttachError::Lost(_)), "{error}");
    }
    // Listens on after the viewer has given up.
    for error in refusals(|peer| while peer.hear().is_some() {}) {
        assert!(matches!(error, AttachError::Timeout { .. }), "{error}");
    }
}

#[test]
fn faults_goodbyes_and_silence_are_told_apart() {
    let daemon = |peer: &mut dyn Peer| {
        peer.welcome();
        peer.say(&ToViewer::Error(Fault::new(Code::BadView, "", "", "")));
        peer.say(&ToViewer::Bye { reason: "it stops".into() });
    };
    let viewer = |attached: &mut Attached| {
        assert!(matches!(attached.next_event(), Ok(Event::Message(ToViewer::Error(_)))));
        let error = attached.next_event().err().unwrap();
        assert!(matches!(&error, AttachError::Bye(reason) if reason == "it stops"), "{error}");
        let error = attached.next_event().err().unwrap();
        assert!(matches!(error, AttachError::Lost(_)), "{error}");
    };
    both(daemon, viewer, &options());
    let quiet = |peer: &mut dyn Peer| {
        peer.welcome();
        while peer.hear().is_some() {}
    };
    let viewer = |attached: &mut Attached| {
        assert!(matches!(attached.next_event(), Err(AttachError::Timeout { .. })));
    };
    both(quiet, viewer, &Options { timeout: Duration::from_millis(200), ..options() });
}

#[test]
fn nobody_there_and_no_web_socket_are_told_apart() {
    for nowhere in ["127.0.0.1:1", "/nowhere/daemon.sock"] {
        assert!(matches!(Attached::to(nowhere, &options()), Err(AttachError::Away { .. })), "{nowhere}");
    }
    let fault = r#"{"code":"token","what":"no token","rule":"","remedy":""}"#;
    for (line, body, status, said) in [("401 Unauthorized", fault, 401, "no token"), ("404 Not Found", "", 404, "")] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let thread = std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let mut request = [0; 4096];
            let bytes = stream.read(&mut request).unwrap();
            let answer = format!("HTTP/1.1 {line}\r\nContent-Length: {}\r\n\r\n{body}", body.len());
            stream.write_all(answer.as_bytes()).unwrap();
            String::from_utf8_lossy(&request[..bytes]).into_owned()
        });
        let error = Attached::to(&address, &Options { token: Some("s3cret".into()), ..options() }).err().unwrap();
        let AttachError::Refused { status: found, reason, .. } = &error else { panic!("{error}") };
        assert_eq!((*found, reason.as_str()), (status, said));
        let request = thread.join().unwrap();
        assert!(request.starts_with("GET /v1/attach HTTP/1.1"), "{request}");
        assert!(request.to_lowercase().contains("authorization: bearer s3cret"), "{request}");
    }
}

#[test]
fn an_answer_that_is_no_http_is_foreign() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let thread = std::thread::spawn(move || listener.accept().unwrap().0.write_all(b"220 mail ready\r\n\r\n").unwrap());
    let error = Attached::to(&address, &options()).err().unwrap();
    assert!(matches!(error, AttachError::Foreign(_) | AttachError::Lost(_)), "{error}");
    thread.join().unwrap();
}
