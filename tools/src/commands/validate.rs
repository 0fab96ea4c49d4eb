//! `relief-bake validate`: Everything a file promises, checked.

use std::io::Write as _;
use std::path::PathBuf;

use crate::commands::Outcome;
use crate::source::Registration;
use crate::validate::{Against, Level, Options, check, validate};
use relief_front::bytes::parse_bytes;
use relief_front::error::ToolError;
use relief_front::publish::publish;

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
    /// Bounds W,S,E,N that the bake was given for inputs without georeference.
    #[arg(long, value_name = "W,S,E,N", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    pub bounds: Vec<f64>,
    /// What those bounds are: edges of cells, or the outermost samples.
    #[arg(long, value_enum)]
    pub registration: Option<RegistrationArg>,
    /// EXR channel that was baked.
    #[arg(long, value_name = "NAME")]
    pub channel: Option<String>,
    /// The geoid grid that the bake added, if it was not EGM96.
    #[arg(long, value_name = "PATH.gtx")]
    pub geoid: Option<PathBuf>,
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

/// See [`Registration`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum RegistrationArg {
    /// Samples are centres of cells.
    Cell,
    /// The outermost samples lie on the bounds.
    Node,
}

impl Args {
    fn against(&self) -> Result<Against, ToolError> {
        let bounds = match self.bounds[..] {
            [] => None,
            [west, south, east, north] => Some([west, south, east, north]),
            _ => {
                return Err(ToolError::usage(
                    format!("--bounds with {} numbers", self.bounds.len()),
                    "four numbers W,S,E,N",
                    "give all four",
                ));
            }
        };
        Ok(Against {
            inputs: self.against.clone(),
            bounds,
            registration: self.registration.map(|registration| match registration {
                RegistrationArg::Cell => Registration::Cell,
                RegistrationArg::Node => Registration::Node,
            }),
            channel: self.channel.clone(),
            geoid: self.geoid.clone(),
        })
    }
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
    let options =
        Options { level, against: args.against()?, memory_bytes: args.memory, quiet: args.quiet, ..Options::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0)).build().map_err(|error| {
        ToolError::usage(
            format!("cannot start the threads: {error}"),
            "the system has room for the threads",
            "choose fewer with --threads",
        )
    })?;
    let report = pool.install(|| validate(&args.file, &options))?;
    if let Some(path) = &args.junit {
        publish(path, |out| out.write_all(report.junit().as_bytes()))?;
    }
    if args.json {
        let json = serde_json::to_string_pretty(&report).map_err(|error| {
            ToolError::usage(
                format!("the report cannot be written as JSON: {error}"),
                "all numbers are finite",
                "leave --json out",
            )
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
