//! `--config`: a TOML file whose keys are the flags' names. Its values become the flags' defaults, so
//! that flags and environment count more.

use std::any::TypeId;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::builder::{OsStr, Resettable};
use clap::{Arg, ArgAction, Command};
use relief_front::error::ToolError;
use toml::{Table, Value};

const SERVE: &str = "serve";

/// A key's flag, and its values as they would be typed.
type Setting = (String, Vec<String>);

/// The command with the defaults of the file that its words or the environment name.
///
/// # Errors
/// A file that cannot be read, a key that no flag has, a value that its flag refuses.
pub fn configured(command: Command, words: &[OsString]) -> Result<Command, ToolError> {
    let Some(path) = named(&command, words) else { return Ok(command) };
    let text = std::fs::read_to_string(&path).map_err(|error| ToolError::Io {
        action: "cannot read the configuration",
        path: path.clone(),
        error,
        remedy: "name a file that the daemon may read".into(),
    })?;
    with(command, &path, &text)
}

/// The file that is named.
fn named(command: &Command, words: &[OsString]) -> Option<PathBuf> {
    // What else is wrong with the words is said later.
    let matches = command.clone().ignore_errors(true).try_get_matches_from(words).ok()?;
    matches.subcommand_matches(SERVE)?.get_one::<PathBuf>("config").cloned()
}

fn with(command: Command, path: &Path, text: &str) -> Result<Command, ToolError> {
    let wrong = |what: String| {
        ToolError::usage(
            format!("--config {}: {}", path.display(), what.trim()),
            "a configuration is TOML; its keys are files and the flags' names without dashes before them, its \
             values what the flags take",
            "correct the file; `reliefd serve --help` lists the flags",
        )
    };
    let table: Table = text.parse().map_err(|error: toml::de::Error| wrong(error.to_string()))?;
    let Some(serve) = command.find_subcommand(SERVE).cloned() else { return Ok(command) };
    let settings = table.iter().map(|(key, value)| setting(&serve, path, key, value).map_err(wrong));
    let settings = settings.collect::<Result<Vec<Setting>, ToolError>>()?;
    accepted(&serve, &settings).map_err(wrong)?;
    Ok(command.mut_subcommand(SERVE, |serve| {
        settings.into_iter().fold(serve, |serve, (id, values)| {
            serve.mut_arg(id, |arg| arg.required(false).default_values(values.into_iter().map(OsStr::from)))
        })
    }))
}

fn setting(serve: &Command, path: &Path, key: &str, value: &Value) -> Result<Setting, String> {
    let arg = serve.get_arguments().filter(|arg| !matches!(arg.get_id().as_str(), "config" | "help" | "version"));
    let arg = arg.into_iter().find(|arg| name(arg) == key).ok_or_else(|| format!("the key {key}"))?;
    let word = |value: &Value| match value {
        Value::String(text) if arg.get_value_parser().type_id() == TypeId::of::<PathBuf>() => {
            Ok(beside(path, text).to_string_lossy().into_owned())
        }
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        Value::Boolean(switch) => Ok(switch.to_string()),
        other => Err(format!("{key}: a value of type {}, which its flag does not take", other.type_str())),
    };
    let values = match value {
        Value::Array(values) if arg.is_positional() => values.iter().map(word).collect::<Result<_, _>>()?,
        value => vec![word(value)?],
    };
    Ok((arg.get_id().to_string(), values))
}

/// What the file calls an argument.
fn name(arg: &Arg) -> &str {
    arg.get_long().unwrap_or(arg.get_id().as_str())
}

/// A path of the file, which starts at its folder.
fn beside(config: &Path, path: &str) -> PathBuf {
    config.parent().unwrap_or(Path::new("")).join(path)
}

/// Refuses values that their flags would refuse, in the flags' own words.
fn accepted(serve: &Command, settings: &[Setting]) -> Result<(), String> {
    let mut words: Vec<String> = Vec::new();
    for (id, values) in settings {
        let Some(arg) = serve.get_arguments().find(|arg| arg.get_id().as_str() == id) else { continue };
        match (arg.get_long(), arg.get_action(), values.as_slice()) {
            (Some(long), ArgAction::SetTrue, [value]) => match value.as_str() {
                "true" => words.push(format!("--{long}")),
                "false" => {}
                other => return Err(format!("{long} = {other}: must be true or false")),
            },
            (Some(long), _, values) => words.extend(values.iter().map(|value| format!("--{long}={value}"))),
            // Files, which are looked at when they are opened.
            (None, ..) => {}
        }
    }
    let alone = serve.clone().no_binary_name(true).mut_args(|arg| arg.required(false).env(Resettable::Reset));
    alone.try_get_matches_from(words).map(|_| ()).map_err(|error| {
        let text = error.to_string();
        // The message, without clap's hints about the command line.
        let message = text.split("\n\nFor more").next().unwrap_or_default();
        message.trim_start_matches("error: ").to_owned()
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;
    use crate::serve::Args;
    use clap::{Args as _, FromArgMatches as _};

    fn command() -> Command {
        Command::new("reliefd").subcommand(Args::augment_args(Command::new(SERVE)))
    }

    fn args(text: &str, words: &str) -> Args {
        let command = with(command(), Path::new("/etc/relief/reliefd.toml"), text).unwrap();
        let matches = command.try_get_matches_from(format!("reliefd serve {words}").split_whitespace()).unwrap();
        Args::from_arg_matches(matches.subcommand_matches(SERVE).unwrap()).unwrap()
    }

    #[test]
    fn files_give_what_flags_do_not() {
        let text = "files = ['earth.relief', '/data/moon.relief']\nlisten = '127.0.0.1:9000'\nmax-viewers = 7\n\
                    headless = true\ntime-budget = 2.5\nmemory-limit = '64MiB'\ntoken-file = 'token'";
        let given = args(text, "");
        assert_eq!(given.files, [Path::new("/etc/relief/earth.relief"), Path::new("/data/moon.relief")]);
        assert_eq!(given.token_file.unwrap(), Path::new("/etc/relief/token"));
        assert_eq!((given.max_viewers, given.memory_limit, given.headless), (7, 64 << 20, true));
        assert_eq!((given.listen, given.time_budget.as_micros()), ("127.0.0.1:9000".parse().unwrap(), 2500));
        let given = args(text, "other.relief --max-viewers 8");
        assert_eq!((given.files.as_slice(), given.max_viewers), ([PathBuf::from("other.relief")].as_slice(), 8));
        assert_eq!(given.listen, "127.0.0.1:9000".parse().unwrap());
        assert!(!args("headless = false", "a.relief").headless);
    }

    #[test]
    fn what_no_flag_takes_is_refused() {
        let refused = |text: &str| with(command(), Path::new("r.toml"), text).unwrap_err().to_string();
        for (text, says) in [
            ("listne = 'auto'", "the key listne"),
            ("config = 'r.toml'", "the key config"),
            ("help = true", "the key help"),
            ("listen = 'everywhere'", "everywhere"),
            ("max-viewers = 0", "0"),
            ("max-viewers = [1, 2]", "max-viewers: a value of type array"),
            ("backend = 'tpu'", "tpu"),
            ("headless = 'maybe'", "true or false"),
            ("memory-limit = 'lots'", "lots"),
            ("listen = ", "line 1"),
            ("[serve]\nlisten = 'auto'", "the key serve"),
        ] {
            let error = refused(text);
            assert!(error.contains(says) && error.contains("r.toml") && error.contains("remedy:"), "{text}: {error}");
        }
    }

    #[test]
    fn the_words_name_the_file() {
        let named = |words: &str| {
            let words: Vec<OsString> = words.split_whitespace().map(OsString::from).collect();
            named(&command(), &words)
        };
        assert_eq!(named("reliefd serve --config a.toml").unwrap(), Path::new("a.toml"));
        assert_eq!(named("reliefd serve --max-viewers 2 --config=a.toml b.relief").unwrap(), Path::new("a.toml"));
        assert_eq!(named("reliefd serve b.relief"), None);
        assert_eq!(named("reliefd"), None);
    }
}
