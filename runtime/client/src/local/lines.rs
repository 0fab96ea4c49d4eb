//! Lines from a Unix socket, and the descriptors that come with some.

use std::collections::VecDeque;
use std::io::IoSliceMut;
use std::mem::MaybeUninit;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::time::Instant;

use relief_protocol::MOST_CAMERAS;
use rustix::net::{RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, recvmsg};

use crate::AttachError;
use crate::error::{closed, is_timeout};
use crate::wire::left;

/// Most bytes of a line: a welcome with many planets is the longest.
const MOST_LINE_BYTES: usize = 1 << 20;

/// Bytes and descriptors as they come.
pub(super) struct Lines {
    stream: UnixStream,
    /// What came after the last line.
    rest: Vec<u8>,
    /// Bytes of it that hold no end of a line.
    searched: usize,
    descriptors: VecDeque<OwnedFd>,
}

impl Lines {
    pub(super) fn new(stream: UnixStream) -> Self {
        Self { stream, rest: Vec::new(), searched: 0, descriptors: VecDeque::new() }
    }

    /// To write to.
    pub(super) fn stream(&self) -> &UnixStream {
        &self.stream
    }

    /// The descriptor of the line that came last: they come in the order of their lines, and never
    /// later than a line's first byte.
    pub(super) fn descriptor(&mut self) -> Option<OwnedFd> {
        self.descriptors.pop_front()
    }

    /// The next line; none when the time is up.
    pub(super) fn next(&mut self, until: Instant) -> Result<Option<String>, AttachError> {
        loop {
            if let Some(line) = self.line()? {
                return Ok(Some(line));
            }
            self.stream.set_read_timeout(Some(left(until))).map_err(AttachError::Lost)?;
            match self.receive() {
                Ok(0) => return Err(closed()),
                Ok(_) => {}
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) if is_timeout(&error) => return Ok(None),
                Err(error) => return Err(AttachError::Lost(error)),
            }
            if self.descriptors.len() > MOST_CAMERAS {
                return Err(AttachError::Foreign("descriptors that belong to no ring".into()));
            }
        }
    }

    fn line(&mut self) -> Result<Option<String>, AttachError> {
        let new = self.rest.get(self.searched..).unwrap_or_default();
        let Some(end) = new.iter().position(|&byte| byte == b'\n').map(|at| self.searched + at) else {
            self.searched = self.rest.len();
            return match self.searched {
                ..=MOST_LINE_BYTES => Ok(None),
                bytes => Err(AttachError::Foreign(format!("a line of more than {bytes} bytes"))),
            };
        };
        self.searched = 0;
        let mut line: Vec<u8> = self.rest.drain(..=end).collect();
        line.pop();
        String::from_utf8(line).map(Some).map_err(|_| AttachError::Foreign("a line that is no UTF-8".into()))
    }

    /// Bytes that came; 0 at the end.
    fn receive(&mut self) -> std::io::Result<usize> {
        let mut bytes = [0; 16 << 10];
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(4))];
        let mut control = RecvAncillaryBuffer::new(&mut space);
        let got = recvmsg(&self.stream, &mut [IoSliceMut::new(&mut bytes)], &mut control, RecvFlags::CMSG_CLOEXEC)?;
        for message in control.drain() {
            if let RecvAncillaryMessage::ScmRights(descriptors) = message {
                self.descriptors.extend(descriptors);
            }
        }
        self.rest.extend_from_slice(bytes.get(..got.bytes).unwrap_or_default());
        Ok(got.bytes)
    }
}
