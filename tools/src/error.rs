//! What went wrong, sorted by who must act, with the value, the rule and the remedy.

use std::path::PathBuf;

/// Every failure that ends a command with exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum ToolError {
    /// What was asked for cannot be done: the caller changes the command.
    #[error("{what}\n  rule: {rule}\n  remedy: {remedy}")]
    Usage {
        /// The value that was given, and where.
        what: String,
        /// What it must satisfy.
        rule: String,
        /// What to type or change.
        remedy: String,
    },
    /// An input raster cannot be used as it is: its owner repairs or describes it.
    #[error("{path}: {what}\n  rule: {rule}\n  remedy: {remedy}")]
    Source {
        /// The input as it was named.
        path: String,
        /// The value found.
        what: String,
        /// What it must satisfy.
        rule: String,
        /// What to do about it.
        remedy: String,
    },
    /// The disk or the operating system said no.
    #[error("{action} {path}: {error}\n  remedy: {remedy}", path = path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// What the system answered.
        #[source]
        error: std::io::Error,
        /// What usually helps.
        remedy: String,
    },
    /// The user pressed Ctrl-C or the process was asked to end.
    #[error(
        "interrupted\n  rule: no output is published before it is whole\n  remedy: run again with --resume to go on"
    )]
    Interrupted,
}

impl ToolError {
    /// A [`ToolError::Usage`] from its three sentences.
    pub fn usage(what: impl Into<String>, rule: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Usage { what: what.into(), rule: rule.into(), remedy: remedy.into() }
    }

    /// A [`ToolError::Source`] about the input `path`.
    pub fn source(
        path: impl Into<String>,
        what: impl Into<String>,
        rule: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Source { path: path.into(), what: what.into(), rule: rule.into(), remedy: remedy.into() }
    }
}
