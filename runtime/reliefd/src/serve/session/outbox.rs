//! What waits to be sent to a viewer. Bounded: pictures by their acknowledgements, messages by this.

use std::sync::Arc;

use relief_protocol::error::{Code, Fault};
use relief_protocol::payload::Header;
use relief_protocol::to_viewer::ToViewer;
use relief_protocol::{MOST_CAMERAS, MOST_UNACKNOWLEDGED};
use tokio::sync::mpsc;

use crate::serve::engine::Hold;

/// Room for all payloads that may be unacknowledged, and as many messages.
const ROOM: usize = 8 * MOST_CAMERAS * MOST_UNACKNOWLEDGED as usize;

/// Something for a viewer.
pub enum Out {
    /// A message.
    Message(ToViewer),
    /// A payload.
    Payload(Payload),
    /// The last message; then the connection is closed.
    End(ToViewer),
}

/// A payload and what it is.
pub struct Payload {
    /// Its header.
    pub header: Header,
    /// Its bytes, without the envelope.
    pub bytes: Vec<u8>,
    /// Dropped once the payload is sent: only then its camera is drawn again.
    pub hold: Arc<Hold>,
}

/// The end that things are put into.
#[derive(Clone)]
pub struct Outbox(mpsc::Sender<Out>);

/// An outbox and its other end.
pub fn outbox() -> (Outbox, mpsc::Receiver<Out>) {
    let (sender, receiver) = mpsc::channel(ROOM);
    (Outbox(sender), receiver)
}

impl Outbox {
    /// Tells the viewer something, once there is room: who does not read is not heard either.
    ///
    /// # Errors
    /// A connection that ended.
    pub async fn tell(&self, message: ToViewer) -> Result<(), Fault> {
        self.0.send(Out::Message(message)).await.map_err(|_| {
            Fault::new(Code::Timeout, "the viewer is gone", "a viewer reads what it is sent", "attach again").fatal()
        })
    }

    /// Ends the connection with a message, once there is room.
    pub async fn end(&self, message: ToViewer) {
        // It may have ended by itself.
        let _ = self.0.send(Out::End(message)).await;
    }

    /// Puts something in without waiting. Where there is no room the viewer has not read for long,
    /// and its connection is about to be given up.
    pub fn post(&self, out: Out) {
        let _ = self.0.try_send(out);
    }
}
