//! `relief-bake report`: Speed against error of steps, kernels and codecs.

use crate::commands::Outcome;
use crate::error::ToolError;

/// Speed against error of steps, kernels and codecs.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(_args: &Args) -> Result<Outcome, ToolError> {
    Ok(Outcome::Good)
}
