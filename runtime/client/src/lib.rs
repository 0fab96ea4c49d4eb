//! A viewer's half of the protocol of `reliefd` (`runtime/PROTOCOL.md`), for programs that block.
//!
//! [`Attached::to`] attaches over a WebSocket or, beside the daemon, over its Unix socket, where
//! payloads are read in shared memory without a copy. Both are used alike: make a camera, send views,
//! take events. `examples/fly.rs` is a whole viewer.
//!
//! ```no_run
//! use relief_client::{Attached, Event, Options};
//! use relief_protocol::to_server::{Frame, Streams};
//! use relief_protocol::view::View;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut daemon = Attached::to("127.0.0.1:7878", &Options::default())?;
//! daemon.camera("main", "earth", Streams { frame: Some(Frame::default()), ..Streams::default() })?;
//! daemon.view("main", View::down([85.0, 19.0, 600_000.0], [1280, 720]))?;
//! while let Event::Payload(payload) = daemon.next_event()? {
//!     std::fs::write("frame.jpg", payload.copied()?)?;
//!     if payload.header().complete {
//!         break;
//!     }
//! }
//! # Ok(())
//! # }
//! ```

mod acks;
pub mod attach;
pub mod error;
#[cfg(target_os = "linux")]
mod local;
pub mod payload;
mod websocket;
mod wire;

pub use acks::Acks;
pub use attach::{Attached, Options};
pub use error::AttachError;
pub use payload::{Event, Payload, Torn};
