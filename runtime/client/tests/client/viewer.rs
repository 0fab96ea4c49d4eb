//! What a viewer does, over either way alike.

use std::time::Duration;

use relief_client::{Acks, AttachError, Attached, Event, Options, Payload};
use relief_protocol::mesh::Vertex;
use relief_protocol::payload::{Format, Header, MeshCounts, Stream};
use relief_protocol::to_server::{Frame, Streams, ToServer};
use relief_protocol::to_viewer::{Picked, ToViewer};
use relief_protocol::view::View;

use crate::fake::{Peer, both, header, options, welcome};

fn payload(attached: &mut Attached) -> Payload {
    match attached.next_event().unwrap() {
        Event::Payload(payload) => payload,
        Event::Message(message) => panic!("{message:?}"),
    }
}

fn ack(seq: u64) -> Option<ToServer> {
    Some(ToServer::Ack { camera: "main".into(), seq })
}

#[test]
fn a_camera_is_made_moved_and_seen() {
    let daemon = |peer: &mut dyn Peer| {
        peer.welcome();
        let Some(ToServer::Camera(camera)) = peer.hear() else { panic!("no camera") };
        assert_eq!((camera.camera.as_str(), camera.planet.as_str(), camera.streams.count()), ("main", "earth", 1));
        let Some(ToServer::View(view)) = peer.hear() else { panic!("no view") };
        assert_eq!((view.view, view.what.pose), (1, vec![1.0, 2.0, 3.0]));
        peer.raw(r#"{"type":"of a later version"}"#);
        // The second outgrows the ring of the first.
        for (seq, bytes) in [(1u64, 10usize), (2, 3 << 20), (3, 0)] {
            peer.show(&header(seq, 0, 2), &vec![seq as u8; bytes]);
            peer.show(&header(seq, 1, 2), b"the other part");
            assert_eq!(peer.hear(), ack(seq));
        }
        let Some(ToServer::Pick(pick)) = peer.hear() else { panic!("no pick") };
        peer.say(&ToViewer::Picked(Picked { camera: pick.camera, id: pick.id, place: None }));
        assert_eq!(peer.hear(), Some(ToServer::Detach { camera: "main".into() }));
        assert_eq!(peer.hear(), None, "no further acknowledgement");
    };
    let viewer = |attached: &mut Attached| {
        assert_eq!((attached.welcome(), attached.planet("earth").is_some()), (&welcome(), true));
        let streams = Streams { frame: Some(Frame::default()), ..Streams::default() };
        attached.camera("main", "earth", streams).unwrap();
        assert_eq!(attached.view("main", View::down([1.0, 2.0, 3.0], [4, 4])).unwrap(), 1);
        for (seq, bytes) in [(1, 10), (2, 3 << 20), (3, 0)] {
            let (first, second) = (payload(attached), payload(attached));
            assert_eq!((first.header(), second.header()), (&header(seq, 0, 2), &header(seq, 1, 2)));
            // A payload may be kept while others come, until its picture is acknowledged.
            assert_eq!(first.copied().unwrap(), vec![seq as u8; bytes]);
            assert_eq!(second.with(<[u8]>::len).unwrap(), b"the other part".len());
            assert!(first.mesh().unwrap().is_none());
        }
        // Asking for an event sends what is due; nothing else comes.
        assert!(attached.next_within(Duration::ZERO).unwrap().is_none());
        let id = attached.pick("main", 0.5, 0.5).unwrap();
        let Event::Message(ToViewer::Picked(picked)) = attached.next_event().unwrap() else { panic!("no answer") };
        assert_eq!((picked.id, picked.place), (id, None));
        attached.detach("main").unwrap();
    };
    both(daemon, viewer, &options());
}

#[test]
fn a_viewer_may_acknowledge_by_hand() {
    let daemon = |peer: &mut dyn Peer| {
        peer.welcome();
        peer.show(&header(7, 0, 1), b"a");
        peer.show(&header(8, 0, 1), b"b");
        assert_eq!(peer.hear(), ack(8));
        peer.show(&header(9, 0, 1), b"c");
        assert_eq!(peer.hear(), None);
    };
    let viewer = |attached: &mut Attached| {
        let (first, second) = (payload(attached), payload(attached));
        assert!(attached.next_within(Duration::ZERO).unwrap().is_none());
        assert_eq!((first.copied().unwrap(), second.copied().unwrap()), (b"a".to_vec(), b"b".to_vec()));
        attached.ack(second.header()).unwrap();
        assert_eq!(payload(attached).header().seq, 9);
    };
    both(daemon, viewer, &Options { acks: Acks::ByHand, ..options() });
}

fn mesh_header(vertices: u32) -> Header {
    let mesh = Some(MeshCounts { vertices, indices: 3 });
    Header { stream: Stream::Mesh, format: Format::Mesh, mesh, ..header(1, 0, 1) }
}

#[test]
fn meshes_are_unpacked_and_broken_ones_refused() {
    const VERTEX: Vertex = Vertex { position_m: [1.0, -2.0, 3.0], s: 5, t: 6, normal: [0.0, 0.0] };
    let daemon = |peer: &mut dyn Peer| {
        peer.welcome();
        let mesh = [&VERTEX.bytes()[..], &[0; 12]].concat();
        peer.show(&mesh_header(1), &mesh);
        peer.show(&mesh_header(2), &mesh);
        while peer.hear().is_some() {}
    };
    let viewer = |attached: &mut Attached| {
        assert_eq!(payload(attached).mesh().unwrap(), Some((vec![VERTEX], vec![0; 3])));
        assert!(matches!(payload(attached).mesh(), Err(AttachError::Foreign(_))));
    };
    both(daemon, viewer, &options());
}

#[test]
fn a_new_file_changes_the_planet() {
    let daemon = |peer: &mut dyn Peer| {
        peer.welcome();
        let mut planet = welcome().planets.remove(0);
        planet.content_id = "11".into();
        peer.say(&ToViewer::Planet(planet));
    };
    let viewer = |attached: &mut Attached| {
        assert!(matches!(attached.next_event(), Ok(Event::Message(ToViewer::Planet(_)))));
        assert_eq!(attached.planet("earth").map(|planet| planet.content_id.as_str()), Some("11"));
    };
    both(daemon, viewer, &options());
}
