//! A viewer, whatever it is attached by: reads its messages, keeps its cameras, and puts what it is
//! to be told into an outbox.

mod outbox;
pub mod pack;
mod pick;

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use relief_protocol::error::{Code, Fault};
use relief_protocol::to_server::{self, SetView, Streams, ToServer};
use relief_protocol::to_viewer::{Limits, ToViewer, Welcome};
use relief_protocol::{MOST_CAMERAS, VERSION};

use super::engine::{Ask, Camera, Sink};
use super::hub::{Hub, Seat, Served};

pub use outbox::{Out, Outbox, outbox};

/// A viewer.
pub struct Session {
    hub: Arc<Hub>,
    seat: Seat,
    outbox: Outbox,
    welcomed: bool,
    /// Its token was shown already, or none is needed.
    trusted: bool,
    cameras: HashMap<String, Attached>,
}

/// A camera of a viewer.
struct Attached {
    served: Arc<Served>,
    camera: Camera,
    streams: Streams,
    view: Option<(u64, Arc<relief_protocol::view::View>)>,
    pick: Option<tokio::task::JoinHandle<()>>,
}

impl Session {
    /// A viewer that took a seat; `trusted` when it need not show a token any more.
    pub fn new(hub: Arc<Hub>, seat: Seat, outbox: Outbox, trusted: bool) -> Self {
        Self { hub, seat, outbox, welcomed: false, trusted, cameras: HashMap::new() }
    }

    /// True once the viewer has said hello and was welcomed.
    pub fn is_welcomed(&self) -> bool {
        self.welcomed
    }

    /// Does what a message says. Faults that leave the connection as it is have been put into the
    /// outbox.
    ///
    /// # Errors
    /// A fatal fault: the caller sends it and closes the connection.
    pub async fn handle(&mut self, text: &str) -> Result<(), Fault> {
        let done = match ToServer::parse(text) {
            Ok(message) => self.obey(message),
            Err(fault) if self.welcomed => Err(fault),
            // A stranger that does not speak the protocol.
            Err(fault) => Err(fault.fatal()),
        };
        match done {
            Ok(answer) => match answer {
                Some(message) => self.outbox.tell(message).await,
                None => Ok(()),
            },
            Err(fault) if fault.fatal => Err(fault),
            Err(fault) => {
                self.hub.meters.fault(fault.code);
                self.outbox.tell(ToViewer::Error(fault)).await
            }
        }
    }

    fn obey(&mut self, message: ToServer) -> Result<Option<ToViewer>, Fault> {
        if !self.welcomed {
            return match message {
                ToServer::Hello(hello) => self.welcome(&hello).map(Some),
                _ => Err(Fault::new(
                    Code::Malformed,
                    "a message before the hello",
                    "the first message is a hello",
                    "send {\"type\":\"hello\",\"version\":1} first",
                )
                .fatal()),
            };
        }
        match message {
            ToServer::Hello(_) => Err(Fault::new(
                Code::Malformed,
                "a second hello",
                "a viewer says hello once",
                "open another connection for another viewer",
            )),
            ToServer::Camera(camera) => self.camera(camera).map(|()| None),
            ToServer::View(view) => self.view(view).map(|()| None),
            ToServer::Ack { camera, seq } => {
                // Of a camera that was just detached: nothing to do.
                if let Some(attached) = self.cameras.get(&camera) {
                    attached.camera.acknowledge(seq);
                }
                Ok(None)
            }
            ToServer::Pick(pick) => self.pick(pick).map(|()| None),
            ToServer::Detach { camera } => {
                self.cameras.remove(&camera).map(|_| None).ok_or_else(|| unknown_camera(&camera))
            }
        }
    }

    fn welcome(&mut self, hello: &to_server::Hello) -> Result<ToViewer, Fault> {
        if hello.version != VERSION {
            return Err(Fault::new(
                Code::Version,
                format!("version {} of the protocol", hello.version),
                format!("this daemon speaks version {VERSION}"),
                "use a viewer and a daemon of the same version",
            )
            .fatal());
        }
        if !self.trusted && !self.hub.admits(hello.token.as_deref()) {
            return Err(self.hub.no_token(hello.token.is_some()).fatal());
        }
        self.welcomed = true;
        tracing::info!(viewer = self.seat.viewer(), name = hello.viewer, "attached");
        Ok(ToViewer::Welcome(Welcome {
            version: VERSION,
            server: concat!("reliefd ", env!("CARGO_PKG_VERSION")).into(),
            viewer: self.seat.viewer(),
            planets: self.hub.planets(),
            limits: Limits::default(),
        }))
    }

    fn camera(&mut self, asked: to_server::Camera) -> Result<(), Fault> {
        let to_server::Camera { camera: name, planet, streams } = asked;
        let served = self.hub.served(&planet).map_err(|fault| fault.of(&name))?;
        if !self.cameras.contains_key(&name) && self.cameras.len() >= MOST_CAMERAS {
            return Err(Fault::new(
                Code::TooLarge,
                format!("a camera more than {MOST_CAMERAS}"),
                format!("a viewer has at most {MOST_CAMERAS} cameras"),
                "detach one first",
            )
            .of(&name));
        }
        let sink = self.sink(&name, streams);
        let camera = served.engine.camera(self.seat.viewer(), sink);
        // A camera that is only changed goes on looking where it looked.
        let view = self.cameras.remove(&name).and_then(|mut earlier| earlier.view.take());
        let attached = Attached { served, camera, streams, view, pick: None };
        attached.ask();
        self.cameras.insert(name, attached);
        Ok(())
    }

    /// Packs and sends a camera's pictures, away from the engine's thread.
    fn sink(&self, name: &str, streams: Streams) -> Sink {
        let (outbox, name, meters) = (self.outbox.clone(), name.to_owned(), Arc::clone(&self.hub.meters));
        let runtime = tokio::runtime::Handle::current();
        Arc::new(move |result| {
            let (outbox, name, meters) = (outbox.clone(), name.clone(), Arc::clone(&meters));
            match result {
                Ok(picture) => {
                    runtime.spawn_blocking(move || {
                        let (began, mut bytes) = (Instant::now(), 0);
                        for payload in pack::payloads(&picture, &name, streams) {
                            bytes += payload.bytes.len() as u64;
                            outbox.post(Out::Payload(payload));
                        }
                        meters.packed(began.elapsed(), bytes);
                    });
                }
                Err(fault) => {
                    meters.fault(fault.code);
                    outbox.post(Out::Message(ToViewer::Error(fault.of(&name))));
                }
            }
        })
    }

    fn view(&mut self, asked: SetView) -> Result<(), Fault> {
        let SetView { camera, view, what } = asked;
        let attached = self.cameras.get_mut(&camera).ok_or_else(|| unknown_camera(&camera).at(view))?;
        attached.view = Some((view, Arc::new(what)));
        attached.ask();
        Ok(())
    }

    fn pick(&mut self, pick: to_server::Pick) -> Result<(), Fault> {
        let attached = self.cameras.get_mut(&pick.camera).ok_or_else(|| unknown_camera(&pick.camera))?;
        let Some((_, what)) = &attached.view else {
            return Err(Fault::new(
                Code::Unknown,
                "a pick of a camera without a view",
                "a pixel is one of the camera's latest view",
                "send a view first",
            )
            .of(&pick.camera));
        };
        if let Some(earlier) = attached.pick.take() {
            earlier.abort();
        }
        let (served, what, outbox, client) =
            (Arc::clone(&attached.served), Arc::clone(what), self.outbox.clone(), self.seat.viewer());
        attached.pick = Some(tokio::spawn(async move {
            let answer = match pick::picked(&served, client, &what, &pick).await {
                Ok(picked) => ToViewer::Picked(picked),
                Err(fault) => ToViewer::Error(fault.of(&pick.camera)),
            };
            // A fatal fault here is one of the connection, which its own task sees too.
            let _ = outbox.tell(answer).await;
        }));
        Ok(())
    }
}

impl Attached {
    /// Asks for pictures of its view, if it has one.
    fn ask(&self) {
        let Some((view, what)) = &self.view else { return };
        self.camera.ask(Ask {
            view: *view,
            what: Arc::clone(what),
            mesh: self.streams.mesh.is_some(),
            places: false,
            arrived: Instant::now(),
            until: None,
        });
    }
}

impl Drop for Attached {
    fn drop(&mut self) {
        if let Some(pick) = self.pick.take() {
            pick.abort();
        }
    }
}

fn unknown_camera(name: &str) -> Fault {
    Fault::new(
        Code::Unknown,
        format!("the camera {name:?}"),
        "a camera is made before it is used",
        "send {\"type\":\"camera\",...} first",
    )
    .of(name)
}
