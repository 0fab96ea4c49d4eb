//! `relief-bake inspect`: What a file holds.

use crate::commands::Outcome;
use crate::error::ToolError;

/// What a file holds.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(_args: &Args) -> Result<Outcome, ToolError> {
    Ok(Outcome::Good)
}
