//! The socket's file: made, watched for viewers, removed.

use std::fs::Metadata;
use std::io::{Error, ErrorKind};
use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _};
use std::os::unix::net;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use relief_front::error::ToolError;
use rustix::fs::Mode;
use rustix::net::{AddressFamily, SocketAddrUnix, SocketFlags, SocketType};
use tokio::net::UnixListener;

use super::viewer;
use crate::serve::hub::Hub;

/// Viewers that may wait to be taken.
const BACKLOG: i32 = 128;
/// Time until the next try where there are no descriptors left for another viewer.
const AGAIN: Duration = Duration::from_millis(100);

/// A socket that only its owner may open; its file goes with it.
#[derive(Debug)]
pub struct Listener {
    listener: UnixListener,
    path: PathBuf,
    /// Device and inode of the file, so that no other's is removed.
    file: (u64, u64),
}

impl Listener {
    /// Listens at a path. A socket's file that nobody listens at any longer is replaced. Needs a
    /// runtime of tokio.
    ///
    /// # Errors
    /// A path that is taken, or where no socket can be made.
    pub fn bind(path: &Path) -> Result<Self, ToolError> {
        let bound = match bound(path) {
            Err(error) if error.kind() == ErrorKind::AddrInUse => {
                remove_stale(path)?;
                bound(path)
            }
            bound => bound,
        };
        let listening = bound.and_then(|socket| {
            let file = std::fs::symlink_metadata(path).map(|file| identity(&file))?;
            Ok(Self { listener: UnixListener::from_std(socket)?, path: path.to_owned(), file })
        });
        listening.map_err(|error| cannot(path, &error))
    }

    /// Takes viewers until it is dropped; who is attached stays.
    pub async fn serve(&self, hub: Arc<Hub>) {
        loop {
            match self.listener.accept().await {
                Ok((stream, _)) => drop(tokio::spawn(viewer::serve(Arc::clone(&hub), stream))),
                Err(error) => {
                    tracing::warn!("a viewer at the Unix socket was not taken: {error}");
                    tokio::time::sleep(AGAIN).await;
                }
            }
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        if std::fs::symlink_metadata(&self.path).is_ok_and(|file| identity(&file) == self.file) {
            // Where it cannot be removed, the next daemon finds that nobody listens.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// A socket at a path; its file is never open to others, not for a moment: Linux gives it the mode
/// that the socket has when it is bound.
fn bound(path: &Path) -> std::io::Result<net::UnixListener> {
    let address = SocketAddrUnix::new(path)?;
    let flags = SocketFlags::CLOEXEC | SocketFlags::NONBLOCK;
    let socket = rustix::net::socket_with(AddressFamily::UNIX, SocketType::STREAM, flags, None)?;
    rustix::fs::fchmod(&socket, Mode::RUSR | Mode::WUSR)?;
    rustix::net::bind(&socket, &address)?;
    rustix::net::listen(&socket, BACKLOG)?;
    Ok(socket.into())
}

/// Removes the file of a socket at which nobody listens.
fn remove_stale(path: &Path) -> Result<(), ToolError> {
    let taken = |what: &str| {
        ToolError::usage(
            format!("--unix {}: {what}", path.display()),
            "a daemon makes its own socket, where there is none that is used",
            "give another path, or stop whoever uses this one",
        )
    };
    let file = std::fs::symlink_metadata(path).map_err(|error| cannot(path, &error))?;
    if !file.file_type().is_socket() {
        return Err(taken("a file that is no socket is there"));
    }
    match net::UnixStream::connect(path) {
        Err(error) if error.kind() == ErrorKind::ConnectionRefused => {
            std::fs::remove_file(path).map_err(|error| cannot(path, &error))
        }
        Ok(_) => Err(taken("somebody listens there")),
        Err(error) => Err(taken(&error.to_string())),
    }
}

fn identity(file: &Metadata) -> (u64, u64) {
    (file.dev(), file.ino())
}

fn cannot(path: &Path, error: &Error) -> ToolError {
    ToolError::usage(
        format!("--unix {}: {error}", path.display()),
        "a socket's path has at most 107 bytes and lies in a folder that can be written to",
        "give another path",
    )
}
