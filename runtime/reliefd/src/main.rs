//! `reliefd`: the command line. Exit code 0: good; 1: ran and found something; 2: could not run.

mod backend;
mod errors;
mod light;
mod mask;
mod mesh;
mod output;
mod probe;
mod render;
mod report;
mod serve;
#[cfg(target_os = "linux")]
mod truncated;
#[cfg(not(target_os = "linux"))]
#[path = "truncated/elsewhere.rs"]
mod truncated;
mod typed;
mod view_args;

use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use relief_front::error::ToolError;
use relief_front::stderr::say;

/// Planet-scale terrain, served at once: frames, meshes, shadows and heights of a .relief file.
///
/// Exit code 0: good; 1: the command ran and found something; 2: it could not run.
#[derive(Parser)]
#[command(name = "reliefd", version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Mask(mask::Args),
    Report(report::Args),
    Probe(probe::Args),
    Serve(serve::Args),
}

/// How a command that could run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// Exit code 0.
    Good,
    /// Exit code 1: the command ran and found something.
    Found,
}

fn main() -> ExitCode {
    match run() {
        Ok(Outcome::Good) => ExitCode::SUCCESS,
        Ok(Outcome::Found) => ExitCode::from(1),
        Err(error) => {
            say(&format!("reliefd: {error}"));
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<Outcome, ToolError> {
    let words: Vec<_> = std::env::args_os().collect();
    let command = serve::configured(Cli::command(), &words)?;
    let matches = command.get_matches_from(words);
    match Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit()).command {
        Command::Render(args) => render::run(&args),
        Command::Mask(args) => mask::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Probe(args) => probe::run(&args),
        Command::Serve(args) => serve::run(&args),
    }
}
