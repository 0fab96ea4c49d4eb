//! Connections: taken, bounded, ended.

use std::convert::Infallible;
use std::future::Future;
use std::net::TcpListener;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpStream;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};

use crate::serve::idle::Watched;
use crate::serve::patience::patience;
use crate::serve::stop::Stop;

/// Connections beyond these wait to be taken. WebSockets do not count: viewers have seats.
const MOST: usize = 4096;
/// Time until the next try where no connection can be taken, as without descriptors.
const AGAIN: Duration = Duration::from_millis(100);

/// What takes and keeps the connections of all listeners.
#[derive(Clone)]
pub struct Connections {
    router: Router,
    /// No request is read any more.
    closing: Stop,
    room: Arc<Semaphore>,
    /// Held by each connection.
    open: mpsc::Sender<Infallible>,
}

/// Ends connections.
pub struct Closer {
    closing: Stop,
    all: mpsc::Receiver<Infallible>,
}

impl Connections {
    /// Connections that a router answers.
    pub fn new(router: Router) -> (Self, Closer) {
        let (open, all) = mpsc::channel(1);
        let closing = Stop::new();
        let closer = Closer { closing: closing.clone(), all };
        (Self { router, closing, room: Arc::new(Semaphore::new(MOST)), open }, closer)
    }

    /// Takes connections until they are closed. Needs a runtime of tokio.
    ///
    /// # Errors
    /// A listener that tokio does not take.
    pub fn take(self, listener: TcpListener) -> std::io::Result<impl Future<Output = ()> + Send> {
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        Ok(async move {
            loop {
                let taken = tokio::select! {
                    taken = self.one(&listener) => taken,
                    () = self.closing.wait() => return,
                };
                match taken {
                    Ok((stream, permit)) => drop(tokio::spawn(self.clone().serve(stream, permit))),
                    Err(error) => {
                        tracing::warn!("a connection was not taken: {error}");
                        tokio::time::sleep(AGAIN).await;
                    }
                }
            }
        })
    }

    async fn one(&self, listener: &tokio::net::TcpListener) -> std::io::Result<(TcpStream, OwnedSemaphorePermit)> {
        let permit = Arc::clone(&self.room).acquire_owned().await.map_err(std::io::Error::other)?;
        let (stream, _) = listener.accept().await?;
        // Pictures and answers are whole when they are written.
        stream.set_nodelay(true)?;
        Ok((stream, permit))
    }

    async fn serve(self, stream: TcpStream, permit: OwnedSemaphorePermit) {
        let Self { router, closing, open, .. } = self;
        let service = TowerToHyperService::new(router);
        let idle = patience().idle;
        let mut builder = http1::Builder::new();
        builder.timer(TokioTimer::new()).header_read_timeout(idle);
        let stream = TokioIo::new(Watched::new(stream, idle));
        let mut connection = std::pin::pin!(builder.serve_connection(stream, service).with_upgrades());
        // What a client did wrong with HTTP itself it was told.
        tokio::select! {
            ended = connection.as_mut() => return drop(ended),
            () = closing.wait() => connection.as_mut().graceful_shutdown(),
        }
        let _ = connection.await;
        drop((open, permit));
    }
}

impl Closer {
    /// Ends all connections after the answers that are on their way.
    pub async fn close(mut self) {
        self.closing.begin();
        // None once nobody can send any more.
        let _ = self.all.recv().await;
    }
}
