//! A daemon of one viewer, over a WebSocket or a Unix socket.

use std::fs::File;
use std::io::{BufRead, BufReader, IoSlice, Write};
use std::mem::MaybeUninit;
use std::net::{TcpListener, TcpStream};
use std::os::fd::AsFd;
use std::os::unix::fs::FileExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::thread::JoinHandle;
use std::time::Duration;

use relief_client::{Attached, Options};
use relief_protocol::payload::{Format, Header, Stats, Stream};
use relief_protocol::ring::Layout;
use relief_protocol::to_server::ToServer;
use relief_protocol::to_viewer::{InRing, Limits, Planet, Ring, ToViewer, Welcome};
use rustix::fs::{MemfdFlags, SealFlags, fcntl_add_seals, memfd_create};
use rustix::net::{SendAncillaryBuffer, SendAncillaryMessage, SendFlags, sendmsg};
use tungstenite::{Message, WebSocket};

/// What a test fears to wait for.
const DEADLINE: Duration = Duration::from_secs(20);

/// The daemon's end of a connection.
pub trait Peer {
    fn hear(&mut self) -> Option<ToServer>;
    fn say(&mut self, message: &ToViewer);
    fn show(&mut self, header: &Header, payload: &[u8]);
    fn raw(&mut self, text: &str);

    fn welcome(&mut self) {
        let Some(ToServer::Hello(hello)) = self.hear() else { panic!("no hello") };
        assert_eq!((hello.version, hello.viewer.as_str()), (1, "a test"));
        self.say(&ToViewer::Welcome(welcome()));
    }
}

pub fn options() -> Options {
    Options { viewer: "a test".into(), timeout: DEADLINE, ..Options::default() }
}

pub fn welcome() -> Welcome {
    let planet = Planet {
        name: "earth".into(),
        body: "earth".into(),
        plane: false,
        a_m: Some(6_378_137.0),
        b_m: Some(6_356_752.3),
        bounds: [-180.0, -90.0, 180.0, 90.0],
        metres_per_unit: None,
        has_time: true,
        m: 9,
        spacing_m: 39_000.0,
        min_m: -10_000.0,
        max_m: 8000.0,
        content_id: "00".into(),
        backend: "none".into(),
    };
    Welcome { version: 1, server: "fake".into(), viewer: 1, planets: vec![planet], limits: Limits::default() }
}

pub fn header(seq: u64, part: u32, parts: u32) -> Header {
    Header {
        stream: Stream::Frame,
        format: Format::Jpeg,
        camera: "main".into(),
        view: seq,
        seq,
        part,
        parts,
        size: [4, 4],
        complete: false,
        sun: [0.0, 0.0],
        stats: Stats::default(),
        mesh: None,
    }
}

/// Over a WebSocket.
pub struct Web(WebSocket<TcpStream>);

impl Peer for Web {
    fn hear(&mut self) -> Option<ToServer> {
        match self.0.read() {
            Ok(Message::Text(text)) => Some(ToServer::parse(&text).unwrap()),
            _ => None,
        }
    }

    fn say(&mut self, message: &ToViewer) {
        self.raw(&message.text());
    }

    fn show(&mut self, header: &Header, payload: &[u8]) {
        let envelope = [header.envelope(), payload.to_vec()].concat();
        self.0.send(Message::binary(envelope)).unwrap();
    }

    fn raw(&mut self, text: &str) {
        self.0.send(Message::text(text)).unwrap();
    }
}

/// Over a Unix socket, with one ring of two slots for the camera `main`.
pub struct Local {
    lines: BufReader<UnixStream>,
    ring: Option<(File, Layout)>,
    slot: u32,
    numbers: [u64; 2],
}

impl Local {
    /// Makes a ring and announces it.
    pub fn announce(&mut self, slot_bytes: u64, seals: SealFlags, bend: impl FnOnce(&mut Ring, &File)) {
        let layout = Layout::new(2, slot_bytes).unwrap();
        let file = File::from(memfd_create("fake", MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING).unwrap());
        file.set_len(layout.bytes()).unwrap();
        file.write_all_at(&layout.head(), 0).unwrap();
        fcntl_add_seals(&file, seals).unwrap();
        let mut ring = Ring { camera: "main".into(), slots: 2, slot_bytes: layout.slot_bytes(), bytes: layout.bytes() };
        bend(&mut ring, &file);
        let line = format!("{}\n", ToViewer::Ring(ring).text());
        let descriptors = [file.as_fd()];
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
        let mut control = SendAncillaryBuffer::new(&mut space);
        assert!(control.push(SendAncillaryMessage::ScmRights(&descriptors)));
        let sent = sendmsg(self.lines.get_ref(), &[IoSlice::new(line.as_bytes())], &mut control, SendFlags::empty());
        assert_eq!(sent, Ok(line.len()));
        (self.ring, self.slot, self.numbers) = (Some((file, layout)), 0, [0; 2]);
    }

    /// Puts an envelope into the next slot and returns what announces it.
    pub fn put(&mut self, header: &Header, payload: &[u8]) -> InRing {
        let envelope = [header.envelope(), payload.to_vec()].concat();
        let (file, layout) = self.ring.as_ref().unwrap();
        let slot = self.slot;
        self.slot = (slot + 1) % 2;
        let number = &mut self.numbers[slot as usize];
        *number += 2;
        file.write_all_at(&(*number - 1).to_le_bytes(), layout.sequence(slot)).unwrap();
        file.write_all_at(&envelope, layout.slot(slot)).unwrap();
        file.write_all_at(&number.to_le_bytes(), layout.sequence(slot)).unwrap();
        InRing { camera: header.camera.clone(), slot, sequence: *number, bytes: envelope.len() as u64 }
    }
}

impl Peer for Local {
    fn hear(&mut self) -> Option<ToServer> {
        let mut line = String::new();
        self.lines.read_line(&mut line).ok().filter(|&bytes| bytes > 0)?;
        Some(ToServer::parse(line.trim_end()).unwrap())
    }

    fn say(&mut self, message: &ToViewer) {
        self.raw(&message.text());
    }

    fn show(&mut self, header: &Header, payload: &[u8]) {
        if self.ring.as_ref().is_none_or(|(_, layout)| layout.slot_bytes() < payload.len() as u64 + 4096) {
            self.announce(payload.len() as u64 + 4096, SealFlags::SHRINK | SealFlags::GROW, |_, _| ());
        }
        let in_ring = self.put(header, payload);
        self.say(&ToViewer::Payload(in_ring));
    }

    fn raw(&mut self, text: &str) {
        self.lines.get_mut().write_all(format!("{text}\n").as_bytes()).unwrap();
    }
}

/// Its address, and the thread in which it plays its part.
pub fn web(part: impl FnOnce(&mut Web) + Send + 'static) -> (String, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let thread = std::thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        stream.set_read_timeout(Some(DEADLINE)).unwrap();
        part(&mut Web(tungstenite::accept(stream).unwrap()));
    });
    (address, thread)
}

/// Its address, and the thread in which it plays its part.
pub fn local(part: impl FnOnce(&mut Local) + Send + 'static) -> (String, JoinHandle<()>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("daemon.sock");
    let address = path.to_str().unwrap().to_owned();
    let listener = UnixListener::bind(&path).unwrap();
    let thread = std::thread::spawn(move || {
        let _folder = folder;
        let (stream, _) = listener.accept().unwrap();
        stream.set_read_timeout(Some(DEADLINE)).unwrap();
        part(&mut Local { lines: BufReader::new(stream), ring: None, slot: 0, numbers: [0; 2] });
    });
    (address, thread)
}

/// Plays both parts over both ways.
pub fn both(daemon: fn(&mut dyn Peer), viewer: fn(&mut Attached), options: &Options) {
    for (address, thread) in [web(move |peer| daemon(peer)), local(move |peer| daemon(peer))] {
        let mut attached = Attached::to(&address, options).unwrap();
        viewer(&mut attached);
        drop(attached);
        thread.join().unwrap();
    }
}
