//! What `reliefd` and its viewers say to each other: `runtime/PROTOCOL.md` as types.
//!
//! Nothing here opens a socket. Both ends use it: the daemon, and `relief-client`.

pub mod error;
pub mod mesh;
pub mod payload;
pub mod ring;
pub mod to_server;
pub mod to_viewer;
pub mod view;

/// Version of the protocol; the first message of a viewer names it.
pub const VERSION: u32 = 1;
/// Most bytes of a message of a viewer.
pub const MOST_MESSAGE_BYTES: usize = 64 << 10;
/// Most cameras of a viewer.
pub const MOST_CAMERAS: usize = 16;
/// Most bytes of a camera's name.
pub const MOST_NAME_BYTES: usize = 64;
/// Most pixels of a view: as many as a little more than 3840 x 2160.
pub const MOST_PIXELS: u64 = 1 << 23;
/// Pictures of a camera that a viewer may leave unacknowledged; then the camera waits.
pub const MOST_UNACKNOWLEDGED: u64 = 2;
