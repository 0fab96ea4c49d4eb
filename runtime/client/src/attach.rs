//! A viewer attached to a daemon.

use std::time::{Duration, Instant};

use relief_protocol::VERSION;
use relief_protocol::payload::Header;
use relief_protocol::to_server::{Camera, Hello, Pick, SetView, Streams, ToServer};
use relief_protocol::to_viewer::{Planet, ToViewer, Welcome};
use relief_protocol::view::View;

use crate::acks::Arrivals;
use crate::websocket::WebSocketWire;
use crate::wire::Wire;
use crate::{Acks, AttachError, Event};

/// How to attach.
#[derive(Clone, Debug)]
pub struct Options {
    /// A name for the daemon's log.
    pub viewer: String,
    /// The daemon's token, where it has one.
    pub token: Option<String>,
    /// How long to wait for the connection, the welcome, an event, and for the daemon to read.
    pub timeout: Duration,
    /// Who acknowledges pictures.
    pub acks: Acks,
}

impl Default for Options {
    fn default() -> Self {
        Self { viewer: "relief-client".into(), token: None, timeout: Duration::from_secs(30), acks: Acks::Auto }
    }
}

/// A viewer attached to a daemon, until it is dropped. A connection that broke is told by the events,
/// after all that came before; sending goes on without an error.
pub struct Attached {
    wire: Box<dyn Wire>,
    welcome: Welcome,
    timeout: Duration,
    acks: Acks,
    arrivals: Arrivals,
    /// Number of the latest view or pick.
    number: u64,
    /// Why nothing can be sent any longer. What the daemon said before it closed is still read: it
    /// says why.
    broken: Option<std::io::Error>,
}

impl Attached {
    /// Attaches to a daemon: `HOST:PORT`, `ws://HOST:PORT`, `http://HOST:PORT`, or the path of its Unix
    /// socket (with a `/` in it, or after `unix:`).
    ///
    /// # Errors
    /// [`AttachError`]; after [`AttachError::Timeout`], too, there is no attachment.
    pub fn to(address: &str, options: &Options) -> Result<Self, AttachError> {
        let mut wire: Box<dyn Wire> = match unix_path(address) {
            Some(path) => local(path, options.timeout)?,
            None => Box::new(WebSocketWire::connect(address, options)?),
        };
        let Options { viewer, token, timeout, acks } = options.clone();
        let broken = sent(wire.send(&ToServer::Hello(Hello { version: VERSION, viewer, token })))?;
        let until = Instant::now() + timeout;
        let welcome = match wire.receive(until)?.map(ended).transpose()? {
            Some(Event::Message(ToViewer::Welcome(welcome))) if welcome.version == VERSION => welcome,
            Some(Event::Message(ToViewer::Welcome(Welcome { version, server, .. }))) => {
                return Err(AttachError::Foreign(format!("{server} speaks version {version}")));
            }
            Some(_) => return Err(AttachError::Foreign("something else than a welcome".into())),
            None => return Err(AttachError::Timeout { after: timeout }),
        };
        Ok(Self { wire, welcome, timeout, acks, arrivals: Arrivals::default(), number: 0, broken })
    }

    /// The daemon's planets and limits.
    #[must_use]
    pub fn welcome(&self) -> &Welcome {
        &self.welcome
    }

    /// A planet of the welcome, or as it was told since.
    #[must_use]
    pub fn planet(&self, name: &str) -> Option<&Planet> {
        self.welcome.planets.iter().find(|planet| planet.name == name)
    }

    /// Makes a camera, or changes its planet and streams.
    ///
    /// # Errors
    /// [`AttachError`]; what the daemon has against it comes as an event.
    pub fn camera(&mut self, camera: &str, planet: &str, streams: Streams) -> Result<(), AttachError> {
        self.send(&ToServer::Camera(Camera { camera: camera.into(), planet: planet.into(), streams }))
    }

    /// Moves a camera; a view that was not drawn yet is forgotten. Returns the number by which
    /// payloads name the view.
    ///
    /// # Errors
    /// [`AttachError`]; what the daemon has against it comes as an event.
    pub fn view(&mut self, camera: &str, what: View) -> Result<u64, AttachError> {
        let view = self.numbered();
        self.send(&ToServer::View(SetView { camera: camera.into(), view, what }))?;
        Ok(view)
    }

    /// Asks what a pixel of the camera's latest view shows, `x` from the left edge, `y` from the top.
    /// Returns the number that [`ToViewer::Picked`] names.
    ///
    /// # Errors
    /// [`AttachError`].
    pub fn pick(&mut self, camera: &str, x: f64, y: f64) -> Result<u64, AttachError> {
        let id = self.numbered();
        self.send(&ToServer::Pick(Pick { camera: camera.into(), id, x, y }))?;
        Ok(id)
    }

    /// Acknowledges a picture by any of its payloads, with [`Acks::ByHand`].
    ///
    /// # Errors
    /// [`AttachError`].
    pub fn ack(&mut self, header: &Header) -> Result<(), AttachError> {
        self.send(&ToServer::Ack { camera: header.camera.clone(), seq: header.seq })
    }

    /// Ends a camera. Payloads that are under way still come.
    ///
    /// # Errors
    /// [`AttachError`].
    pub fn detach(&mut self, camera: &str) -> Result<(), AttachError> {
        self.arrivals.forget(camera);
        self.send(&ToServer::Detach { camera: camera.into() })
    }

    /// The next event.
    ///
    /// # Errors
    /// [`AttachError::Timeout`] when none comes within the options' timeout; faults that end the
    /// connection and the daemon's goodbye are errors, too.
    pub fn next_event(&mut self) -> Result<Event, AttachError> {
        self.next_within(self.timeout)?.ok_or(AttachError::Timeout { after: self.timeout })
    }

    /// The next event; none when none comes in that time, which may be zero.
    ///
    /// # Errors
    /// As [`Self::next_event`].
    pub fn next_within(&mut self, timeout: Duration) -> Result<Option<Event>, AttachError> {
        self.acknowledge()?;
        let event = self.wire.receive(Instant::now() + timeout)?.map(ended).transpose()?;
        match &event {
            None => self.broken.take().map_or(Ok(()), |error| Err(AttachError::Lost(error)))?,
            Some(Event::Payload(payload)) if self.acks == Acks::Auto => {
                self.arrivals.arrived(payload.header());
                if !payload.is_shared() {
                    self.acknowledge()?;
                }
            }
            Some(Event::Message(ToViewer::Planet(new))) => {
                self.welcome.planets.iter_mut().filter(|old| old.name == new.name).for_each(|old| *old = new.clone());
            }
            _ => {}
        }
        Ok(event)
    }

    fn acknowledge(&mut self) -> Result<(), AttachError> {
        self.arrivals.due().iter().try_for_each(|ack| self.send(ack))
    }

    fn send(&mut self, message: &ToServer) -> Result<(), AttachError> {
        if self.broken.is_none() {
            self.broken = sent(self.wire.send(message))?;
        }
        Ok(())
    }

    fn numbered(&mut self) -> u64 {
        self.number += 1;
        self.number
    }
}

/// A connection that broke, apart from other errors.
fn sent(done: Result<(), AttachError>) -> Result<Option<std::io::Error>, AttachError> {
    match done {
        Err(AttachError::Lost(error)) => Ok(Some(error)),
        done => done.map(|()| None),
    }
}

/// An event that ends a connection, as an error.
fn ended(event: Event) -> Result<Event, AttachError> {
    match event {
        Event::Message(ToViewer::Error(fault)) if fault.fatal => Err(AttachError::Fault(fault)),
        Event::Message(ToViewer::Bye { reason }) => Err(AttachError::Bye(reason)),
        other => Ok(other),
    }
}

/// The path of a Unix socket, where an address is one.
fn unix_path(address: &str) -> Option<&str> {
    let is_path = !address.contains("://") && address.contains('/');
    address.strip_prefix("unix:").or(is_path.then_some(address))
}

#[cfg(target_os = "linux")]
fn local(path: &str, timeout: Duration) -> Result<Box<dyn Wire>, AttachError> {
    Ok(Box::new(crate::local::LocalWire::connect(path, timeout)?))
}

#[cfg(not(target_os = "linux"))]
fn local(path: &str, _: Duration) -> Result<Box<dyn Wire>, AttachError> {
    Err(AttachError::Address { given: path.into(), what: "Unix sockets and their rings need Linux".into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_told_from_hosts() {
        assert_eq!(unix_path("unix:reliefd.sock"), Some("reliefd.sock"));
        assert_eq!(unix_path("unix:/run/reliefd.sock"), Some("/run/reliefd.sock"));
        assert_eq!(unix_path("./reliefd.sock"), Some("./reliefd.sock"));
        for host in ["localhost:7878", "ws://localhost:7878/v1/attach", "http://[::1]:7878"] {
            assert_eq!(unix_path(host), None);
        }
    }
}
