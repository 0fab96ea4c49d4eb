//! The way over a WebSocket.

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use relief_protocol::error::Fault;
use relief_protocol::ring::MOST_SLOT_BYTES;
use relief_protocol::to_server::ToServer;
use tungstenite::handshake::HandshakeError;
use tungstenite::http::Uri;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{ClientRequestBuilder, Error, Message, WebSocket};

use crate::error::{closed, is_timeout};
use crate::payload::Payload;
use crate::wire::{Wire, left, message};
use crate::{AttachError, Event, Options};

/// A WebSocket to a daemon.
pub(crate) struct WebSocketWire {
    socket: WebSocket<TcpStream>,
    timeout: Duration,
}

impl WebSocketWire {
    /// Connects, showing the token as a bearer's.
    pub(crate) fn connect(address: &str, options: &Options) -> Result<Self, AttachError> {
        let (host, uri) = target(address)?;
        let timeout = options.timeout.max(Duration::from_millis(1));
        let stream = dial(&host, timeout).map_err(|error| AttachError::Away { address: host.clone(), error })?;
        let mut request = ClientRequestBuilder::new(uri);
        if let Some(token) = &options.token {
            request = request.with_header("Authorization", format!("Bearer {token}"));
        }
        let most = Some(MOST_SLOT_BYTES as usize);
        let config = WebSocketConfig::default().max_message_size(most).max_frame_size(most);
        match tungstenite::client::client_with_config(request, stream, Some(config)) {
            Ok((socket, _)) => Ok(Self { socket, timeout }),
            Err(HandshakeError::Interrupted(_)) => Err(AttachError::Timeout { after: timeout }),
            Err(HandshakeError::Failure(error)) => Err(refused(host, error)),
        }
    }
}

impl Wire for WebSocketWire {
    fn send(&mut self, message: &ToServer) -> Result<(), AttachError> {
        match self.socket.send(Message::text(message.text())) {
            Err(Error::Io(error)) if is_timeout(&error) => Err(AttachError::Timeout { after: self.timeout }),
            done => done.map_err(broken),
        }
    }

    fn receive(&mut self, until: Instant) -> Result<Option<Event>, AttachError> {
        loop {
            self.socket.get_ref().set_read_timeout(Some(left(until))).map_err(AttachError::Lost)?;
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    if let Some(message) = message(&text)? {
                        return Ok(Some(Event::Message(message)));
                    }
                }
                Ok(Message::Binary(envelope)) => return Payload::own(envelope).map(Event::Payload).map(Some),
                Ok(Message::Close(_)) => return Err(closed()),
                Ok(_) => {}
                Err(Error::Io(error)) if is_timeout(&error) => return Ok(None),
                Err(error) => return Err(broken(error)),
            }
            if Instant::now() >= until {
                return Ok(None);
            }
        }
    }
}

impl Drop for WebSocketWire {
    fn drop(&mut self) {
        // The daemon need not be there any longer.
        let _ = self.socket.close(None);
        let _ = self.socket.flush();
    }
}

/// Host and port, and what to ask for there.
fn target(address: &str) -> Result<(String, Uri), AttachError> {
    let bad = |what: &str| AttachError::Address { given: address.into(), what: what.into() };
    let (scheme, rest) = address.split_once("://").unwrap_or(("ws", address));
    match scheme {
        "ws" | "http" => {}
        "wss" | "https" => return Err(bad("this client speaks no TLS; go through a tunnel")),
        _ => return Err(bad("neither ws:// nor http://")),
    }
    let (host, path) = rest.split_once('/').unwrap_or((rest, ""));
    let path = if path.is_empty() { "v1/attach" } else { path };
    let uri: Uri = format!("ws://{host}/{path}").parse().map_err(|_| bad("no host and port"))?;
    match uri.port_u16() {
        Some(_) => Ok((host.into(), uri)),
        None => Err(bad("a port is missing")),
    }
}

/// Tries all addresses of a host.
fn dial(host: &str, timeout: Duration) -> io::Result<TcpStream> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for address in host.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, timeout) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(timeout))?;
                stream.set_write_timeout(Some(timeout))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Why a handshake failed.
fn refused(address: String, error: Error) -> AttachError {
    match error {
        Error::Http(answer) => {
            let status = answer.status().as_u16();
            let body = answer.into_body().unwrap_or_default();
            let reason = serde_json::from_slice(&body)
                .map_or_else(|_| String::from_utf8_lossy(&body).trim().to_owned(), |fault: Fault| fault.what);
            AttachError::Refused { address, status, reason }
        }
        Error::HttpFormat(error) => AttachError::Address { given: address, what: error.to_string() },
        error => broken(error),
    }
}

fn broken(error: Error) -> AttachError {
    match error {
        Error::Io(error) => AttachError::Lost(error),
        Error::ConnectionClosed | Error::AlreadyClosed => closed(),
        Error::Protocol(tungstenite::error::ProtocolError::ResetWithoutClosingHandshake) => closed(),
        error => AttachError::Foreign(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_understood_or_refused() {
        for (given, uri) in [
            ("localhost:7878", "ws://localhost:7878/v1/attach"),
            ("http://127.0.0.1:80/", "ws://127.0.0.1:80/v1/attach"),
            ("ws://[::1]:7878/behind/v1/attach?token=t", "ws://[::1]:7878/behind/v1/attach?token=t"),
        ] {
            assert_eq!(target(given).unwrap().1.to_string(), uri);
        }
        for given in ["wss://host:1", "ftp://host:1", "localhost", "", "ws://:", "a b:1", "host:99999"] {
            assert!(matches!(target(given), Err(AttachError::Address { .. })), "{given}");
        }
    }
}
