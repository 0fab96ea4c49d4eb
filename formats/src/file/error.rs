//! What can go wrong with a `.relief` file, sorted by who must act.

use std::path::PathBuf;

use crate::codec::CodecError;
use crate::tile::TileKey;

/// A file that cannot be opened, read or written.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The disk or the operating system said no.
    #[error("{action}: {error} ({path})", path = path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// What the system answered.
        #[source]
        error: std::io::Error,
    },
    /// The bytes are not a `.relief` file at all.
    #[error("not a .relief file: {0}")]
    NotRelief(&'static str),
    /// A newer writer used something this reader does not know.
    #[error("the file needs a newer reader: {0}")]
    Unsupported(String),
    /// The file is cut, or changed since it was written.
    #[error("damaged file: {0}")]
    Damaged(String),
    /// One tile's plane is damaged; the rest of the file may be good.
    #[error("damaged tile: {plane} of level {} tile ({}, {}): {error}", key.level, key.x, key.y)]
    Tile {
        /// Which tile.
        key: TileKey,
        /// Which of its planes.
        plane: &'static str,
        /// What its bytes show.
        error: CodecError,
    },
    /// The caller asked for something the file cannot have.
    #[error("{0}")]
    Request(String),
}

impl FormatError {
    pub(crate) fn damaged(what: impl Into<String>) -> Self {
        Self::Damaged(what.into())
    }
}
