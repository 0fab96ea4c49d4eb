//! `relief-bake`: the command line. Exit code 0: good; 1: ran and found something; 2: could not run.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use relief_front::stderr::say;
use relief_tools::commands::{self, Outcome};

/// Planet-scale terrain, prepared once: elevation rasters in, one validated .relief file out.
///
/// Exit code 0: good; 1: the command ran and found something; 2: it could not run.
#[derive(Parser)]
#[command(name = "relief-bake", version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Bake(commands::bake::Args),
    Validate(commands::validate::Args),
    Inspect(commands::inspect::Args),
    Probe(commands::probe::Args),
    Diff(commands::diff::Args),
    Export(commands::export::Args),
    Preview(commands::preview::Args),
    Report(commands::report::Args),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Bake(args) => commands::bake::run(&args),
        Command::Validate(args) => commands::validate::run(&args),
        Command::Inspect(args) => commands::inspect::run(&args),
        Command::Probe(args) => commands::probe::run(&args),
        Command::Diff(args) => commands::diff::run(&args),
        Command::Export(args) => commands::export::run(&args),
        Command::Preview(args) => commands::preview::run(&args),
        Command::Report(args) => commands::report::run(&args),
    };
    match result {
        Ok(Outcome::Good) => ExitCode::SUCCESS,
        Ok(Outcome::Found) => ExitCode::from(1),
        Err(error) => {
            say(&format!("relief-bake: {error}"));
            ExitCode::from(2)
        }
    }
}
