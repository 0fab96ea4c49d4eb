//! `relief-bake preview`: A shaded picture of a file.

use crate::commands::Outcome;
use crate::error::ToolError;

/// A shaded picture of a file.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(_args: &Args) -> Result<Outcome, ToolError> {
    Ok(Outcome::Good)
}
