//! A writer that overwrites what its reader is looking at.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use relief_client::{Acks, AttachError, Attached, Event, Options};
use relief_protocol::payload::{Format, Header, Stats, Stream};
use relief_protocol::to_viewer::{Limits, ToViewer, Welcome};
use tokio::net::UnixListener;

use crate::serve::local::lines::{Lines, send};
use crate::serve::local::rings::Rings;

/// Bytes of a payload, all the same: enough that a copy takes longer than a turn of the reader.
const BYTES: usize = 1 << 18;
/// Overwritten and whole payloads that are enough, and the time until they must have been met.
const ENOUGH: u32 = 20;
const DEADLINE: Duration = Duration::from_secs(30);

fn header(seq: u64) -> Header {
    Header {
        stream: Stream::Mask,
        format: Format::U8,
        camera: "main".into(),
        view: 0,
        seq,
        part: 0,
        parts: 1,
        size: [1, 1],
        complete: false,
        sun: [0.0; 2],
        stats: Stats::default(),
        mesh: None,
    }
}

/// A daemon that heeds no acknowledgements.
async fn pour(listener: UnixListener, stop: Arc<AtomicBool>) {
    let (stream, _) = listener.accept().await.unwrap();
    Lines::new(&stream).next().await.unwrap();
    let welcome = Welcome {
        version: relief_protocol::VERSION,
        server: String::new(),
        viewer: 1,
        planets: Vec::new(),
        limits: Limits::default(),
    };
    send(&stream, &ToViewer::Welcome(welcome).text(), None).await.unwrap();
    let mut rings = Rings::default();
    for seq in 0.. {
        let placed = rings.place(&header(seq), &[seq as u8; BYTES]).unwrap();
        if let Some((ring, descriptor)) = &placed.ring {
            send(&stream, &ring.text(), Some(*descriptor)).await.unwrap();
        }
        if stop.load(Ordering::Relaxed) || send(&stream, &placed.payload.text(), None).await.is_err() {
            return;
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_torn_payload_passes_for_a_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("relief.sock");
    let stop = Arc::new(AtomicBool::new(false));
    let daemon = tokio::spawn(pour(UnixListener::bind(&path).unwrap(), Arc::clone(&stop)));
    let (whole, torn) = tokio::task::spawn_blocking(move || {
        let options = Options { acks: Acks::ByHand, ..Options::default() };
        let mut attached = Attached::to(path.to_str().unwrap(), &options).unwrap();
        let (mut whole, mut torn, begin) = (0, 0, Instant::now());
        while (whole < ENOUGH || torn < ENOUGH) && begin.elapsed() < DEADLINE {
            let payload = match attached.next_event() {
                Ok(Event::Payload(payload)) => payload,
                Err(AttachError::Torn(_)) => {
                    torn += 1;
                    continue;
                }
                other => panic!("{other:?}"),
            };
            let seq = payload.header().seq;
            match payload.with(|bytes| bytes.len() == BYTES && bytes.iter().all(|&byte| byte == seq as u8)) {
                Ok(good) => {
                    assert!(good, "a torn payload passed for a whole one");
                    whole += 1;
                }
                Err(_) => torn += 1,
            }
        }
        stop.store(true, Ordering::Relaxed);
        (whole, torn)
    })
    .await
    .unwrap();
    daemon.await.unwrap();
    // The writer is far ahead at times and close at others: both kinds are met.
    assert!(whole >= ENOUGH && torn >= ENOUGH, "{whole} whole, {torn} torn");
}
