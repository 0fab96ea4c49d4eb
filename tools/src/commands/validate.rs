//! `relief-bake validate`: Everything a file promises, checked.

use std::io::Write as _;
use std::path::PathBuf;

use crate::commands::Outcome;
use crate::error::ToolError;
use crate::publish::publish;
use crate::validate::{Level, Options, check, validate};

/// Everything a file promises, checked.
///
/// Exit code 0: good (there may be warnings); 1: errors were found; 2: could not run.
#[derive(Debug, clap::Args)]
#[command(after_long_help = check::table())]
pub struct Args {
    /// The .relief file.
    pub file: PathBuf,
    /// The rasters it was baked from, in the same order; implies --level source.
    #[arg(long, num_args = 1.., value_name = "INPUT")]
    pub against: Vec<String>,
    /// How deep to check; each level includes those before it [default: semantic].
    #[arg(long, value_enum)]
    pub level: Option<Level>,
    /// Print one JSON object instead of text.
    #[arg(long)]
    pub json: bool,
    /// Also write the outcome as JUnit XML.
    #[arg(long, value_name = "OUT.xml")]
    pub junit: Option<PathBuf>,
    /// Memory to use, with an optional suffix KiB, MiB or GiB.
    #[arg(long, default_value = "1GiB", value_parser = parse_bytes, value_name = "BYTES")]
    pub memory: u64,
    /// Threads to use [default: one for each core].
    #[arg(long)]
    pub threads: Option<usize>,
    /// No progress.
    #[arg(long)]
    pub quiet: bool,
}

/// Bytes as typed: a number and, if any, a binary suffix.
fn parse_bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let shift = match &text[digits.len()..] {
        "" | "B" => 0,
        "K" | "KiB" => 10,
        "M" | "MiB" => 20,
        "G" | "GiB" => 30,
        _ => return Err("a number of bytes, KiB, MiB or GiB".into()),
    };
    let number: u64 = digits.trim().parse().map_err(|_| "a number of bytes, KiB, MiB or GiB".to_owned())?;
    number.checked_mul(1 << shift).filter(|&bytes| bytes >= 1 << 26).ok_or_else(|| "from 64MiB on".into())
}

/// Runs the command.
///
/// # Errors
/// What kept it from running.
pub fn run(args: &Args) -> Result<Outcome, ToolError> {
    let level = args.level.unwrap_or(if args.against.is_empty() { Level::Semantic } else { Level::Source });
    if (level == Level::Source) == args.against.is_empty() {
        return Err(ToolError::usage(
            format!("--level {} with {} inputs to compare with", level.name(), args.against.len()),
            "--level source and --against INPUT... go together",
            "name the inputs after --against, or choose another level",
        ));
    }
    let options = Options { level, memory_bytes: args.memory, quiet: args.quiet, ..Options::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0)).build().map_err(|error| {
        ToolError::usage(format!("cannot start the threads: {error}"), "the system has room for the threads", "choose fewer with --threads")
    })?;
    let report = pool.install(|| validate(&args.file, &options))?;
    if let Some(path) = &args.junit {
        publish(path, |out| out.write_all(report.junit().as_bytes()))?;
    }
    if args.json {
        let json = serde_json::to_string_pretty(&report).map_err(|error| {
            ToolError::usage(format!("the report cannot be written as JSON: {error}"), "all numbers are finite", "leave --json out")
        })?;
        print(&format!("{json}\n"))?;
    } else {
        print(&report.text())?;
    }
    Ok(if report.good { Outcome::Good } else { Outcome::Found })
}

/// Writes to standard output; a reader that has gone away is not an error.
fn print(text: &str) -> Result<(), ToolError> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(ToolError::Io {
            action: "cannot write to",
            path: "standard output".into(),
            error,
            remedy: "free some space, or choose another output".into(),
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_as_typed() {
        assert_eq!(parse_bytes("1GiB"), Ok(1 << 30));
        assert_eq!(parse_bytes("268435456"), Ok(1 << 28));
        assert_eq!(parse_bytes("512 MiB"), Ok(1 << 29));
        for bad in ["", "GiB", "1TB", "-1GiB", "1KiB", "99999999999GiB"] {
            assert!(parse_bytes(bad).is_err(), "{bad}");
        }
    }
}
