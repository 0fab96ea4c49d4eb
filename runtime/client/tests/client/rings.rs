//! Rings that break their promises.

use relief_client::{Acks, AttachError, Attached, Event, Options};
use relief_protocol::to_viewer::{InRing, Ring, ToViewer};
use rustix::fs::SealFlags;
use std::fs::File;
use std::os::unix::fs::FileExt;

use crate::fake::{Local, Peer, header, local, options};

const SEALS: SealFlags = SealFlags::SHRINK.union(SealFlags::GROW);

/// The viewer's next event after the daemon has played its part.
fn after(part: impl FnOnce(&mut Local) + Send + 'static) -> Result<Event, AttachError> {
    let (address, thread) = local(move |peer| {
        peer.welcome();
        part(peer);
    });
    let mut attached = Attached::to(&address, &options()).unwrap();
    let event = attached.next_event();
    drop(attached);
    thread.join().unwrap();
    event
}

#[test]
fn rings_that_are_none_are_refused() {
    type Bend = fn(&mut Ring, &File);
    let cases: [(&str, SealFlags, Bend); 6] = [
        ("that may shrink", SealFlags::GROW, |_, _| ()),
        ("has", SEALS, |ring, _| ring.bytes -= 1),
        ("head", SEALS, |ring, _| ring.slots = 1),
        ("head", SEALS, |ring, _| ring.slot_bytes *= 2),
        ("head", SEALS, |_, file| file.write_all_at(b"r", 0).unwrap()),
        ("head", SEALS, |_, file| file.write_all_at(&[255; 8], 24).unwrap()),
    ];
    for (told, seals, bend) in cases {
        let error = after(move |peer| peer.announce(5000, seals, bend)).err().unwrap();
        assert!(matches!(&error, AttachError::Foreign(what) if what.contains(told)), "{told}: {error}");
    }
    let bare = ToViewer::Ring(Ring { camera: "main".into(), slots: 2, slot_bytes: 4096, bytes: 12288 });
    let error = after(move |peer| peer.say(&bare)).err().unwrap();
    assert!(error.to_string().contains("without a descriptor"), "{error}");
}

#[test]
fn payloads_beyond_a_ring_are_refused() {
    for bend in [|said: &mut InRing| said.slot = 2, |said: &mut InRing| said.bytes = 8193] {
        let error = after(move |peer| {
            peer.announce(5000, SEALS, |_, _| ());
            let mut said = peer.put(&header(1, 0, 1), b"payload");
            bend(&mut said);
            peer.say(&ToViewer::Payload(said));
        });
        assert!(matches!(error, Err(AttachError::Foreign(_))), "{error:?}");
    }
    // A header that cannot be read, and one that is longer than the payload's bytes.
    for bytes in [3, 40] {
        let error = after(move |peer| {
            peer.announce(5000, SEALS, |_, _| ());
            let mut said = peer.put(&header(1, 0, 1), b"payload");
            said.bytes = bytes;
            peer.say(&ToViewer::Payload(said));
        });
        assert!(matches!(error, Err(AttachError::Foreign(_))), "{error:?}");
    }
}

#[test]
fn an_overwritten_payload_is_torn_before_and_after_it_is_seen() {
    let (address, thread) = local(|peer| {
        peer.welcome();
        peer.announce(5000, SEALS, |_, _| ());
        // Two slots: the third payload overwrites the first before the viewer hears of either.
        let said: Vec<InRing> = (1..=3).map(|seq| peer.put(&header(seq, 0, 1), &[seq as u8; 100])).collect();
        said.into_iter().for_each(|in_ring| peer.say(&ToViewer::Payload(in_ring)));
        assert!(peer.hear().is_some());
        // Overwrites both without a word.
        for seq in 4..=5 {
            peer.put(&header(seq, 0, 1), b"new");
        }
        assert!(peer.hear().is_none());
    });
    let mut attached = Attached::to(&address, &Options { acks: Acks::ByHand, ..options() }).unwrap();
    let error = attached.next_event().err().unwrap();
    assert!(matches!(error, AttachError::Torn(torn) if (torn.announced, torn.found) == (2, 4)), "{error}");
    // It stays usable.
    let payloads = [(); 2].map(|()| match attached.next_event().unwrap() {
        Event::Payload(payload) => payload,
        other => panic!("{other:?}"),
    });
    assert_eq!(payloads[1].copied().unwrap(), vec![3; 100]);
    // The daemon overwrites while a closure looks.
    let seen = payloads[0].with(|bytes| {
        attached.ack(payloads[0].header()).unwrap();
        while payloads[0].with(|_| ()).is_ok() {
            std::thread::yield_now();
        }
        bytes.len()
    });
    assert_eq!(seen.unwrap_err().announced, 2);
    drop(attached);
    thread.join().unwrap();
}

#[test]
fn payloads_outlive_their_ring_and_their_daemon() {
    let (address, thread) = local(|peer| {
        peer.welcome();
        peer.show(&header(1, 0, 1), b"first");
        peer.show(&header(2, 0, 1), &[9; 100_000]);
    });
    let mut attached = Attached::to(&address, &options()).unwrap();
    let payloads = [(); 2].map(|()| match attached.next_event() {
        Ok(Event::Payload(payload)) => payload,
        other => panic!("{other:?}"),
    });
    drop(attached);
    thread.join().unwrap();
    assert_eq!((payloads[0].copied().unwrap(), payloads[1].copied().unwrap().len()), (b"first".to_vec(), 100_000));
}
