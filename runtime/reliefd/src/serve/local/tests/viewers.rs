//! Viewers at a daemon without planets.

use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use relief_client::{AttachError, Attached, Event, Options};
use relief_protocol::error::Code;
use relief_protocol::to_server::{Mask, Streams};
use relief_protocol::to_viewer::ToViewer;

use crate::serve::hub::Hub;
use crate::serve::local::Listener;
use crate::serve::meters::Meters;

/// A daemon with so many seats, what a viewer does with it, and the hub while it does.
async fn with(seats: usize, viewer: impl FnOnce(PathBuf, &Hub) + Send + 'static) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("relief.sock");
    // A token is not asked for here.
    let hub = Arc::new(Hub::new(seats, Some("s3cret"), Arc::new(Meters::default())));
    let listener = Listener::bind(&path).unwrap();
    let theirs = Arc::clone(&hub);
    let done = tokio::task::spawn_blocking(move || viewer(path, &theirs));
    tokio::select! {
        done = done => done.unwrap(),
        () = listener.serve(hub) => panic!("it serves until it is dropped"),
    }
}

fn attached(path: &std::path::Path) -> Result<Attached, AttachError> {
    Attached::to(path.to_str().unwrap(), &Options { timeout: Duration::from_secs(20), ..Options::default() })
}

/// What the daemon says to bytes of any kind until it closes.
fn answer(path: &std::path::Path, bytes: &[u8]) -> String {
    let mut stream = UnixStream::connect(path).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    // It may close before all is written.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8(answer).unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn viewers_are_welcomed_corrected_and_seen_off() {
    with(4, |path, hub| {
        let mut viewer = attached(&path).unwrap();
        assert!(viewer.welcome().planets.is_empty());
        viewer.camera("main", "earth", Streams { mask: Some(Mask::default()), ..Streams::default() }).unwrap();
        let Event::Message(ToViewer::Error(fault)) = viewer.next_event().unwrap() else { panic!("no fault") };
        assert_eq!((fault.code, fault.camera.as_deref()), (Code::Unknown, Some("main")));
        hub.tell(ToViewer::Bye { reason: "it stops".into() });
        assert!(matches!(viewer.next_event(), Err(AttachError::Bye(_))));
        assert!(matches!(viewer.next_event(), Err(AttachError::Lost(_))));
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_full_daemon_says_so_until_a_viewer_leaves() {
    with(1, |path, _| {
        let first = attached(&path).unwrap();
        let refused = attached(&path).err().unwrap();
        assert!(matches!(&refused, AttachError::Fault(fault) if fault.code == Code::Busy), "{refused}");
        drop(first);
        let begin = std::time::Instant::now();
        while attached(&path).is_err() {
            assert!(begin.elapsed() < Duration::from_secs(20), "the seat is not freed");
            std::thread::yield_now();
        }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn strangers_are_told_what_is_wrong_and_go() {
    with(4, |path, _| {
        let mut viewer = attached(&path).unwrap();
        let hello = b"{\"type\":\"hello\",\"version\":1}\n";
        for (bytes, code) in [
            (b"GET / HTTP/1.1\r\n\r\n".to_vec(), "malformed"),
            (b"\n".to_vec(), "malformed"),
            (b"\xff\xfe\n".to_vec(), "malformed"),
            (b"{\"type\":\"hello\",\"version\":2}\n".to_vec(), "version"),
            (vec![b'x'; 100_000], "too_large"),
            ([&hello[..], &[b' '; 70_000], b"\n"].concat(), "too_large"),
            ([&hello[..], &[0xc3, b'\n']].concat(), "malformed"),
        ] {
            let answer = answer(&path, &bytes);
            let last = answer.lines().last().unwrap_or_default();
            let Ok(ToViewer::Error(fault)) = ToViewer::parse(last) else { panic!("{answer:?}") };
            assert!(fault.fatal && last.contains(&format!("\"code\":\"{code}\"")), "{last}");
        }
        // The others go on.
        viewer.detach("none").unwrap();
        assert!(matches!(viewer.next_event(), Ok(Event::Message(ToViewer::Error(_)))));
    })
    .await;
}
