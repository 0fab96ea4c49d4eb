//! A viewer at the Unix socket: one task that reads and writes.

use std::sync::Arc;
use std::time::Duration;

use relief_protocol::error::{Code, Fault};
use relief_protocol::to_viewer::ToViewer;
use tokio::net::UnixStream;
use tokio::sync::{broadcast, mpsc};
use tokio::time::{Instant, timeout, timeout_at};

use super::lines::{Lines, send};
use super::rings::Rings;
use crate::serve::hub::Hub;
use crate::serve::patience::patience;
use crate::serve::session::{Out, Session, outbox};

/// Serves a viewer until it goes.
pub async fn serve(hub: Arc<Hub>, stream: UnixStream) {
    let peer = stream.peer_cred().ok();
    let (pid, uid) = (peer.and_then(|peer| peer.pid()), peer.map(|peer| peer.uid()));
    let seat = match hub.seat() {
        Ok(seat) => seat,
        Err(fault) => return refuse(&hub, &stream, fault).await,
    };
    let viewer = seat.viewer();
    tracing::info!(viewer, pid, uid, "a viewer at the Unix socket");
    let (outbox, receiver) = outbox();
    let news = hub.news();
    // Who may open the socket needs no token.
    let session = Session::new(Arc::clone(&hub), seat, outbox.clone(), true);
    let mut writing = std::pin::pin!(write(&stream, receiver, news, patience().send));
    let last = tokio::select! {
        last = read(session, &stream) => last,
        () = &mut writing => return tracing::info!(viewer, "detached: it does not read, or is gone"),
    };
    tracing::info!(viewer, code = ?last.as_ref().map(|fault| fault.code), "detached");
    if let Some(fault) = last {
        hub.meters.fault(fault.code);
        let ending = async { tokio::join!(outbox.end(ToViewer::Error(fault)), writing) };
        // A viewer that does not read is not told.
        let _ = timeout(patience().send, ending).await;
    }
}

/// Tells a viewer why it has no seat.
async fn refuse(hub: &Hub, stream: &UnixStream, fault: Fault) {
    hub.meters.fault(fault.code);
    // It may be gone.
    let _ = timeout(patience().send, send(stream, &ToViewer::Error(fault).text(), None)).await;
}

/// Reads until the viewer goes; the fault it is to be told last, if there is one.
async fn read(mut session: Session, stream: &UnixStream) -> Option<Fault> {
    let mut lines = Lines::new(stream);
    let hello = Instant::now() + patience().hello;
    loop {
        // The system tells when a local viewer is gone: after the hello it may be silent.
        let line = match session.is_welcomed() {
            true => lines.next().await,
            false => timeout_at(hello, lines.next()).await.unwrap_or_else(|_| Err(silence())),
        };
        match line {
            Ok(Some(line)) => {
                if let Err(fault) = session.handle(&line).await {
                    return Some(fault);
                }
            }
            Ok(None) => return None,
            Err(fault) => return Some(fault),
        }
    }
}

/// Writes until the last message, or until the viewer does not take one in time.
async fn write(
    stream: &UnixStream,
    mut receiver: mpsc::Receiver<Out>,
    mut news: broadcast::Receiver<ToViewer>,
    in_time: Duration,
) {
    let mut rings = Rings::default();
    loop {
        let out = tokio::select! {
            out = receiver.recv() => out,
            heard = news.recv() => match heard {
                Ok(bye @ ToViewer::Bye { .. }) => Some(Out::End(bye)),
                Ok(message) => Some(Out::Message(message)),
                // It was too slow to hear all.
                Err(broadcast::error::RecvError::Lagged(_)) => continue,
                Err(broadcast::error::RecvError::Closed) => None,
            },
        };
        let Some(out) = out else { return };
        let last = matches!(out, Out::End(_));
        let sent = timeout(in_time, put(stream, &mut rings, out)).await;
        if last || !matches!(sent, Ok(Ok(()))) {
            return;
        }
    }
}

/// Sends one thing.
async fn put(stream: &UnixStream, rings: &mut Rings, out: Out) -> std::io::Result<()> {
    let payload = match out {
        Out::Message(message) | Out::End(message) => return send(stream, &message.text(), None).await,
        Out::Payload(payload) => payload,
    };
    match rings.place(&payload.header, &payload.bytes) {
        Ok(placed) => {
            if let Some((ring, descriptor)) = &placed.ring {
                send(stream, &ring.text(), Some(*descriptor)).await?;
            }
            send(stream, &placed.payload.text(), None).await
        }
        Err(error) => {
            let fault = Fault::new(
                Code::Internal,
                format!("shared memory for a payload of {} bytes: {error}", payload.bytes.len()),
                "the system has memory and descriptors for each camera's ring",
                "ask for smaller pictures, or attach by the WebSocket",
            );
            let fault = fault.of(&payload.header.camera).at(payload.header.view);
            tracing::warn!("{}", fault.what);
            send(stream, &ToViewer::Error(fault).text(), None).await
        }
    }
}

fn silence() -> Fault {
    Fault::new(Code::Timeout, "silence", "a viewer says hello within 10 seconds", "attach again").fatal()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_viewer_that_does_not_read_is_given_up() {
        let (ours, theirs) = UnixStream::pair().unwrap();
        let (outbox, receiver) = outbox();
        let (_teller, news) = broadcast::channel(1);
        let talking = async {
            // The daemon's buffer and the system's: more than both hold.
            while outbox.tell(ToViewer::Bye { reason: "x".repeat(60_000) }).await.is_ok() {}
        };
        let writing = write(&ours, receiver, news, Duration::from_millis(50));
        timeout(Duration::from_secs(20), async { tokio::join!(talking, writing) }).await.unwrap();
        drop(theirs);
    }
}
