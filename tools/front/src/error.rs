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
    #[error(
        "{action} {path}: {error}\n  rule: what is read can be read whole, what is written finds room\n  remedy: {remedy}",
        path = path.display()
    )]
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
    /// A `.relief` file cannot be opened, read or written.
    #[error("{path}: {error}\n  rule: {rule}\n  remedy: {remedy}", path = path.display(), rule = format_rule(error), remedy = format_remedy(error))]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        #[source]
        error: relief_formats::file::FormatError,
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

impl ToolError {
    /// For `map_err` on what the formats crate says of the file at `path`.
    pub fn of_file(path: &std::path::Path) -> impl Fn(relief_formats::file::FormatError) -> Self + Copy + '_ {
        move |error| Self::File { path: path.to_path_buf(), error }
    }
}

fn format_rule(error: &relief_formats::file::FormatError) -> &'static str {
    use relief_formats::file::FormatError;
    match error {
        FormatError::Io { .. } => "the file can be read or written",
        FormatError::NotRelief(_) => "a .relief file starts with its signature and a whole header",
        FormatError::Unsupported(_) => "a reader knows every required feature of a file",
        FormatError::Damaged(_) | FormatError::Tile { .. } => "a file is as it was published, to the last bit",
        FormatError::Request(_) => "a file answers for the levels, tiles and places it has",
    }
}

fn format_remedy(error: &relief_formats::file::FormatError) -> &'static str {
    use relief_formats::file::FormatError;
    match error {
        FormatError::Io { .. } => "check that the path exists, can be read or written, and that the disk has room",
        FormatError::NotRelief(_) => "name a file that `relief-bake bake` wrote",
        FormatError::Unsupported(_) => "use a newer relief-bake",
        FormatError::Damaged(_) | FormatError::Tile { .. } => {
            "copy the file again or bake it again; `relief-bake validate` lists all damage"
        }
        FormatError::Request(_) => "ask for something the file has; see `relief-bake inspect`",
    }
}
