//! `relief-bake bake`: from elevation rasters to a `.relief` file.

use crate::commands::Outcome;
use crate::error::ToolError;

/// Bake elevation rasters into one `.relief` file.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(_args: &Args) -> Result<Outcome, ToolError> {
    Ok(Outcome::Good)
}
