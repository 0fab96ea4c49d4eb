//! The WebSocket that viewers attach by: a task that reads, a task that writes.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, State};
use axum::http::HeaderMap;
use axum::response::Response;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use relief_protocol::MOST_MESSAGE_BYTES;
use relief_protocol::error::{Code, Fault};
use relief_protocol::to_viewer::ToViewer;
use tokio::sync::{broadcast, mpsc};
use tungstenite::error::ProtocolError;

use crate::serve::hub::Hub;
use crate::serve::patience::patience;
use crate::serve::session::{Out, Session, outbox};

/// Bytes that are read at once.
const READ_BYTES: usize = 8 << 10;

/// A query with the token, where there is one.
#[derive(serde::Deserialize)]
pub struct Token {
    /// As it was sent.
    pub token: Option<String>,
}

/// `GET /v1/attach`.
pub async fn attach(
    State(hub): State<Arc<Hub>>,
    Query(Token { token }): Query<Token>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    let token = super::token(&headers).or(token);
    upgrade
        // Viewers' messages are short, and there may be many viewers.
        .read_buffer_size(READ_BYTES)
        // What is a little too long is read and refused; what is longer ends the connection.
        .max_message_size(4 * MOST_MESSAGE_BYTES)
        .max_frame_size(4 * MOST_MESSAGE_BYTES)
        .on_upgrade(move |socket| serve(hub, socket, token))
}

async fn serve(hub: Arc<Hub>, socket: WebSocket, token: Option<String>) {
    let (sink, stream) = socket.split();
    let (outbox, receiver) = outbox();
    let mut writer = tokio::spawn(write(sink, receiver, hub.news()));
    // A token that is shown must be right; without one the hello may bring it.
    let trusted = hub.admits(token.as_deref());
    let seat = match token.is_some() && !trusted {
        true => Err(hub.no_token(true).fatal()),
        false => hub.seat(),
    };
    let last = match seat {
        Err(fault) => Some(fault),
        Ok(seat) => {
            let viewer = seat.viewer();
            let session = Session::new(Arc::clone(&hub), seat, outbox.clone(), trusted);
            let last = tokio::select! {
                last = read(session, stream) => last,
                // The viewer does not read, or is gone.
                _ = &mut writer => return tracing::info!(viewer, "detached: it does not read, or is gone"),
            };
            tracing::info!(viewer, code = ?last.as_ref().map(|fault| fault.code), "detached");
            last
        }
    };
    if let Some(fault) = last {
        hub.meters.fault(fault.code);
        let _ = tokio::time::timeout(patience().send, async {
            outbox.end(ToViewer::Error(fault)).await;
            let _ = (&mut writer).await;
        })
        .await;
    }
    writer.abort();
}

/// Reads until the viewer goes; the fault it is to be told last, if there is one.
async fn read(mut session: Session, mut stream: SplitStream<WebSocket>) -> Option<Fault> {
    let hello = tokio::time::Instant::now() + patience().hello;
    loop {
        let patience = match session.is_welcomed() {
            true => tokio::time::Instant::now() + patience().silence,
            false => hello,
        };
        let Ok(message) = tokio::time::timeout_at(patience, stream.next()).await else {
            let rule = match session.is_welcomed() {
                true => "a viewer answers pings",
                false => "a viewer says hello within 10 seconds",
            };
            return Some(Fault::new(Code::Timeout, "silence", rule, "attach again").fatal());
        };
        match message {
            Some(Ok(Message::Text(text))) => {
                if let Err(fault) = session.handle(&text).await {
                    return Some(fault);
                }
            }
            Some(Ok(Message::Binary(bytes))) => return Some(binary(bytes.len()).fatal()),
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
            Some(Ok(Message::Close(_))) | None => return None,
            Some(Err(error)) => return broken(error).map(Fault::fatal),
        }
    }
}

/// Writes until the last message, or until the viewer takes no more.
async fn write(
    mut sink: SplitSink<WebSocket, Message>,
    mut receiver: mpsc::Receiver<Out>,
    mut news: broadcast::Receiver<ToViewer>,
) {
    let mut ping = tokio::time::interval(patience().ping);
    loop {
        let mut held = None;
        let (message, last) = tokio::select! {
            out = receiver.recv() => match out {
                Some(Out::Message(message)) => (text(&message), false),
                Some(Out::Payload(payload)) => {
                    let mut bytes = payload.header.envelope();
                    bytes.extend_from_slice(&payload.bytes);
                    held = Some(payload.hold);
                    (Message::Binary(bytes.into()), false)
                }
                Some(Out::End(message)) => (text(&message), true),
                None => return,
            },
            heard = news.recv() => match heard {
                Ok(message) => (text(&message), matches!(message, ToViewer::Bye { .. })),
                // It was too slow to hear all.
                Err(broadcast::error::RecvError::Lagged(_)) => continue,
                Err(broadcast::error::RecvError::Closed) => return,
            },
            _ = ping.tick() => (Message::Ping(Bytes::new()), false),
        };
        let sent = tokio::time::timeout(patience().send, async {
            sink.send(message).await?;
            if last {
                sink.send(Message::Close(Some(CloseFrame { code: 1000, reason: Utf8Bytes::default() }))).await?;
            }
            Ok::<(), axum::Error>(())
        });
        let taken = matches!(sent.await, Ok(Ok(())));
        drop(held);
        if last || !taken {
            return;
        }
    }
}

fn text(message: &ToViewer) -> Message {
    Message::Text(message.text().into())
}

fn binary(bytes: usize) -> Fault {
    Fault::new(
        Code::Malformed,
        format!("a binary message of {bytes} bytes"),
        "a viewer's messages are text, one JSON object each",
        "send text",
    )
}

/// What a viewer did wrong; none where it is only gone.
fn broken(error: axum::Error) -> Option<Fault> {
    use tungstenite::Error::{AlreadyClosed, ConnectionClosed, Io, Protocol};
    let said = error.to_string();
    let inner = error.into_inner();
    let gone = matches!(
        inner.downcast_ref(),
        Some(Io(_) | ConnectionClosed | AlreadyClosed | Protocol(ProtocolError::ResetWithoutClosingHandshake))
    );
    let rule = format!("a viewer's messages are WebSocket text of at most {MOST_MESSAGE_BYTES} bytes");
    (!gone).then(|| Fault::new(Code::Malformed, said, rule, "attach again"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_gone_did_nothing_wrong() {
        let of = |error: tungstenite::Error| broken(axum::Error::new(error));
        let reset = std::io::Error::from(std::io::ErrorKind::ConnectionReset);
        assert_eq!(of(tungstenite::Error::Io(reset)), None);
        assert_eq!(of(ProtocolError::ResetWithoutClosingHandshake.into()), None);
        let fault = of(ProtocolError::UnmaskedFrameFromClient.into()).unwrap();
        assert!(fault.code == Code::Malformed && !fault.what.is_empty(), "{fault}");
    }
}
