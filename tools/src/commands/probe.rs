//! `relief-bake probe`: Heights at points.

use crate::commands::Outcome;
use crate::error::ToolError;

/// Heights at points.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(_args: &Args) -> Result<Outcome, ToolError> {
    Ok(Outcome::Good)
}
