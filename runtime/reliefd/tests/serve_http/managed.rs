//! systemd: readiness, the watchdog, sockets that are handed over.

use std::net::TcpListener;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixDatagram;
use std::process::{Command, Stdio};

use crate::daemon::{Daemon, Files, PATIENCE};

/// What a service manager hears.
struct Manager(UnixDatagram);

impl Manager {
    fn new(files: &Files) -> Self {
        let socket = UnixDatagram::bind(files.path("notify")).unwrap();
        socket.set_read_timeout(Some(PATIENCE)).unwrap();
        Self(socket)
    }

    /// Listens until a line is heard.
    fn hears(&self, line: &str) {
        let mut heard = String::new();
        let mut bytes = [0; 4096];
        while !heard.lines().any(|known| known == line) {
            let count = self.0.recv(&mut bytes).unwrap_or_else(|error| panic!("{line} after {heard:?}: {error}"));
            heard += std::str::from_utf8(&bytes[..count]).unwrap();
            heard.push('\n');
        }
    }
}

#[test]
fn the_manager_hears_of_readiness_life_and_end() {
    let files = Files::new();
    let manager = Manager::new(&files);
    let mut command = files.command("serve DIR/globe.relief --backend cpu --listen auto");
    command.env("NOTIFY_SOCKET", files.path("notify")).env("WATCHDOG_USEC", "400000");
    let daemon = Daemon::spawn(command);
    manager.hears("READY=1");
    daemon.get("/healthz").good();
    manager.hears("WATCHDOG=1");
    manager.hears("WATCHDOG=1");
    daemon.signal("TERM");
    manager.hears("STOPPING=1");
    assert_eq!(daemon.ended().0, 0);
}

/// A daemon that is handed a socket as descriptor 3.
fn handed(files: &Files, socket: impl Into<OwnedFd>, words: &str) -> Command {
    let script = "exec 3<&0 </dev/null; export LISTEN_PID=$$ LISTEN_FDS=1; exec \"$0\" \"$@\"";
    let mut command = Command::new("sh");
    command.args(["-c", script, env!("CARGO_BIN_EXE_reliefd")]).args(files.words(words));
    command.stdin(Stdio::from(socket.into())).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

#[test]
fn sockets_are_taken_from_the_manager() {
    let files = Files::new();
    let socket = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = socket.local_addr().unwrap().to_string();
    // Where it is told to listen does not count then.
    let daemon = Daemon::spawn(handed(&files, socket, "serve DIR/globe.relief --backend cpu --listen 127.0.0.9:1"));
    assert_eq!(daemon.address(), address);
    daemon.get("/v1/planets").good();
}

#[test]
fn sockets_that_cannot_be_taken_are_named() {
    let files = Files::new();
    let words = "serve DIR/globe.relief --backend cpu";
    let open = TcpListener::bind("0.0.0.0:0").unwrap();
    let unix = std::os::unix::net::UnixListener::bind(files.path("a.socket")).unwrap();
    let datagram = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let mut cases = [
        (handed(&files, open, words), "--token-file"),
        (handed(&files, unix, words), "--unix"),
        (handed(&files, datagram, words), "TCP"),
    ];
    for (command, says) in &mut cases {
        let output = command.output().unwrap();
        let log = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && log.contains(*says), "{says}: {log}");
    }
}
