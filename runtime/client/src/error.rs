//! Why a viewer is not attached, or not any longer, sorted by who must act.

use std::time::Duration;

use relief_protocol::error::Fault;

use crate::payload::Torn;

/// What ended an attachment or kept it from beginning. Only [`Self::Timeout`] and [`Self::Torn`] leave
/// it usable.
#[derive(Debug, thiserror::Error)]
pub enum AttachError {
    /// The viewer's user: no address of a daemon.
    #[error(
        "the address {given:?}: {what}\n  rule: an address is HOST:PORT, ws://HOST:PORT, or the path of a Unix socket\n  remedy: give what `reliefd serve` printed when it started"
    )]
    Address {
        /// What was given.
        given: String,
        /// What is wrong with it.
        what: String,
    },
    /// Whoever runs the daemon: nobody answers there.
    #[error(
        "no daemon at {address}: {error}\n  rule: a daemon listens there and may be reached\n  remedy: start `reliefd serve`, or give another address"
    )]
    Away {
        /// Where.
        address: String,
        /// What the system said.
        #[source]
        error: std::io::Error,
    },
    /// The viewer's user or the daemon's: what answers there takes no viewer.
    #[error(
        "{address} refused with HTTP status {status}: {reason}\n  rule: a daemon takes viewers that show its token, while there is room\n  remedy: give its token, or try again later"
    )]
    Refused {
        /// Where.
        address: String,
        /// The status.
        status: u16,
        /// The body of the answer.
        reason: String,
    },
    /// The viewer's author, mostly: the daemon ended the connection for this fault.
    #[error("the daemon ended the connection: {0}")]
    Fault(#[source] Fault),
    /// Nobody: the daemon stops.
    #[error(
        "the daemon said goodbye: {0}\n  rule: an attachment lasts as long as its daemon\n  remedy: attach again when it is back"
    )]
    Bye(String),
    /// Whoever runs the daemon, or the network between: the connection broke.
    #[error(
        "the connection to the daemon broke: {0}\n  rule: both ends stay there\n  remedy: attach again; if it keeps breaking, see the daemon's log"
    )]
    Lost(#[source] std::io::Error),
    /// Nothing came in time.
    #[error(
        "nothing came from the daemon for {} s\n  rule: it answers within the timeout that the viewer set\n  remedy: wait longer; a first picture of a large view takes its time without a GPU",
        .after.as_secs_f64()
    )]
    Timeout {
        /// How long was waited.
        after: Duration,
    },
    /// The authors of either end: what came is nothing that a daemon of this version sends.
    #[error(
        "{0}\n  rule: a daemon speaks as PROTOCOL.md says, version 1\n  remedy: use a client and a daemon of the same release"
    )]
    Foreign(String),
    /// A payload was overwritten before it could be looked at.
    #[error(transparent)]
    Torn(#[from] Torn),
}

/// Whether a read or write ended because its time was up.
pub(crate) fn is_timeout(error: &std::io::Error) -> bool {
    matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut)
}

/// The other end is no longer there.
pub(crate) fn closed() -> AttachError {
    AttachError::Lost(std::io::Error::new(std::io::ErrorKind::UnexpectedEof, "closed by the daemon"))
}
