//! Standard output. A reader that has seen enough (`| head`) is no error.

use std::io::{self, Write as _};

use crate::error::ToolError;

/// Writes text to standard output.
///
/// # Errors
/// What the system answered, unless the reader has gone away.
pub fn print(text: &str) -> Result<(), ToolError> {
    let mut out = io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    settle(written).map(|_| ())
}

/// True when output was taken, false when the reader has gone away.
///
/// # Errors
/// Any other answer of the system.
pub fn settle(written: io::Result<()>) -> Result<bool, ToolError> {
    match written {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(ToolError::Io {
            action: "cannot write to",
            path: "standard output".into(),
            error,
            remedy: "check where standard output goes, and that its disk has room".into(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_reader_that_has_gone_is_forgiven() {
        assert!(settle(Ok(())).unwrap());
        assert!(!settle(Err(io::ErrorKind::BrokenPipe.into())).unwrap());
        assert!(settle(Err(io::ErrorKind::StorageFull.into())).is_err());
    }
}
