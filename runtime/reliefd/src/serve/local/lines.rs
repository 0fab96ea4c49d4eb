//! Lines over a Unix socket, and the descriptors that go with some. Nothing blocks.

use std::io::{Error, ErrorKind, IoSlice};
use std::mem::MaybeUninit;
use std::os::fd::BorrowedFd;

use relief_protocol::MOST_MESSAGE_BYTES;
use relief_protocol::error::{Code, Fault};
use rustix::net::{SendAncillaryBuffer, SendAncillaryMessage, SendFlags, sendmsg};
use tokio::io::Interest;
use tokio::net::UnixStream;

/// Bytes that are read at once.
const CHUNK: usize = 4096;

/// What a viewer says, line by line.
pub struct Lines<'a> {
    stream: &'a UnixStream,
    /// What came after the last line.
    rest: Vec<u8>,
    /// Bytes of it that hold no end of a line.
    searched: usize,
}

impl<'a> Lines<'a> {
    /// From here on.
    pub fn new(stream: &'a UnixStream) -> Self {
        Self { stream, rest: Vec::new(), searched: 0 }
    }

    /// The next line; none when the viewer is gone.
    ///
    /// # Errors
    /// A line that is too long, or no text; fatal.
    pub async fn next(&mut self) -> Result<Option<String>, Fault> {
        loop {
            if let Some(line) = self.line()? {
                return Ok(Some(line));
            }
            let mut chunk = [0; CHUNK];
            let got = match self.stream.readable().await {
                Ok(()) => self.stream.try_read(&mut chunk),
                Err(error) => Err(error),
            };
            match got {
                Ok(0) => return Ok(None),
                Ok(bytes) => self.rest.extend_from_slice(chunk.get(..bytes).unwrap_or_default()),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
                // Reset: it is gone as well.
                Err(_) => return Ok(None),
            }
        }
    }

    fn line(&mut self) -> Result<Option<String>, Fault> {
        let new = self.rest.get(self.searched..).unwrap_or_default();
        let end = new.iter().position(|&byte| byte == b'\n').map(|at| self.searched + at);
        let bytes = end.unwrap_or(self.rest.len());
        if bytes > MOST_MESSAGE_BYTES {
            return Err(Fault::new(
                Code::TooLarge,
                format!("a line of {bytes} bytes or more"),
                format!("a message has at most {MOST_MESSAGE_BYTES} bytes"),
                "end each message with a line feed",
            )
            .fatal());
        }
        let Some(end) = end else {
            self.searched = self.rest.len();
            return Ok(None);
        };
        self.searched = 0;
        let mut line: Vec<u8> = self.rest.drain(..=end).collect();
        line.pop();
        String::from_utf8(line).map(Some).map_err(|error| {
            Fault::new(Code::Malformed, error.to_string(), "a message is UTF-8", "send JSON as UTF-8").fatal()
        })
    }
}

/// Sends a line, and a descriptor with its first byte.
///
/// # Errors
/// A viewer that is gone.
pub async fn send(stream: &UnixStream, text: &str, mut descriptor: Option<BorrowedFd<'_>>) -> std::io::Result<()> {
    let line = format!("{text}\n");
    let mut rest = line.as_bytes();
    while !rest.is_empty() {
        let sent = stream.async_io(Interest::WRITABLE, || send_some(stream, rest, descriptor)).await?;
        if sent == 0 {
            return Err(Error::from(ErrorKind::WriteZero));
        }
        // It went with the first byte.
        descriptor = None;
        rest = rest.get(sent..).unwrap_or_default();
    }
    Ok(())
}

fn send_some(stream: &UnixStream, bytes: &[u8], descriptor: Option<BorrowedFd<'_>>) -> std::io::Result<usize> {
    let descriptors: Vec<BorrowedFd<'_>> = descriptor.into_iter().collect();
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
    let mut control = SendAncillaryBuffer::new(&mut space);
    if !descriptors.is_empty() && !control.push(SendAncillaryMessage::ScmRights(&descriptors)) {
        return Err(Error::from(ErrorKind::OutOfMemory));
    }
    // A viewer that is gone is an error, not a signal.
    Ok(sendmsg(stream, &[IoSlice::new(bytes)], &mut control, SendFlags::NOSIGNAL | SendFlags::DONTWAIT)?)
}
