use proptest::prelude::*;

use super::*;
use crate::to_server::Hello;

#[test]
fn messages_are_read() {
    let text = r#"{"type":"view","camera":"main","view":3,"pose":[85,19,6e5,5,-38],"size":[640,360],"sun":[4,15],"overlay":"lod"}"#;
    let Ok(ToServer::View(SetView { view: 3, what, .. })) = ToServer::parse(text) else { panic!("{text}") };
    assert_eq!(what.six(), [85.0, 19.0, 6e5, 5.0, -38.0, 0.0]);
    let hello = ToServer::parse(r#"{"type":"hello","version":1,"colour":"red"}"#);
    assert_eq!(hello, Ok(ToServer::Hello(Hello { version: 1, viewer: String::new(), token: None })));
    let camera = r#"{"type":"camera","camera":"a","planet":"earth","streams":{"frame":{"quality":50},"mesh":{}}}"#;
    let Ok(ToServer::Camera(Camera { streams, .. })) = ToServer::parse(camera) else { panic!("{camera}") };
    assert_eq!((streams.count(), streams.frame.map(|f| f.quality)), (2, Some(50)));
}

#[test]
fn bad_messages_say_what_is_wrong() {
    let pose = |pose: &str, rest: &str| format!(r#"{{"type":"view","camera":"c","view":9,"pose":{pose},{rest}}}"#);
    for (text, code) in [
        (String::new(), Code::Malformed),
        ("[]".into(), Code::Malformed),
        (r#"{"type":"fly"}"#.into(), Code::Malformed),
        (r#"{"type":"hello","version":-1}"#.into(), Code::Malformed),
        (r#"{"type":"detach","camera":""}"#.into(), Code::Malformed),
        (format!(r#"{{"type":"detach","camera":"{}"}}"#, "x".repeat(65)), Code::Malformed),
        (r#"{"type":"camera","camera":"a","planet":"p"}"#.into(), Code::Malformed),
        (r#"{"type":"camera","camera":"a","planet":"p","streams":{"frame":{"quality":0}}}"#.into(), Code::Malformed),
        (r#"{"type":"pick","camera":"a","x":1e999,"y":0}"#.into(), Code::Malformed),
        (pose("[1,2]", r#""size":[8,8]"#), Code::BadView),
        (pose("[1,2,NaN]", r#""size":[8,8]"#), Code::Malformed),
        (pose("[1,2,3]", r#""size":[0,8]"#), Code::BadView),
        (pose("[1,2,3]", r#""size":[8,8],"sun":[0,0],"time":"2026-06-21T00:00:00Z""#), Code::BadView),
        (pose("[1,2,3]", r#""size":[4000000000,4000000000]"#), Code::TooLarge),
        (" ".repeat(MOST_MESSAGE_BYTES + 1), Code::TooLarge),
    ] {
        let fault = ToServer::parse(&text).unwrap_err();
        assert_eq!(fault.code, code, "{text:.80} {fault}");
    }
    let fault = ToServer::parse(&pose("[1,2]", r#""size":[8,8]"#)).unwrap_err();
    assert_eq!((fault.camera.as_deref(), fault.view), (Some("c"), Some(9)));
}

proptest! {
    #[test]
    fn no_text_ends_in_a_panic(text in ".{0,200}", at in 0usize..200, byte in any::<char>()) {
        let _ = ToServer::parse(&text);
        let good = r#"{"type":"view","camera":"main","view":3,"pose":[85,19,600000.0],"fov":60.0,"size":[640,360]}"#;
        let bent: String = good.chars().enumerate().map(|(k, c)| if k == at { byte } else { c }).collect();
        if let Ok(message) = ToServer::parse(&bent) {
            prop_assert_eq!(ToServer::parse(&message.text()), Ok(message));
        }
    }
}
