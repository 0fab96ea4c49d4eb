//! Queries in the words of the command line: the same flags, parsed by the same parser, so that
//! neither their names nor their meanings can differ. Their OpenAPI description comes from there too.

use std::any::TypeId;

use axum::extract::{FromRequestParts, Query};
use axum::http::request::Parts;
use clap::builder::ValueParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, ArgAction, Command};
use relief_protocol::error::{Code, Fault};
use utoipa::IntoParams;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::{ObjectBuilder, Type};
use utoipa::openapi::{Required, Schema};

use super::refused::Refused;

/// Arguments that came as a query.
#[derive(Debug)]
pub struct Words<T>(pub T);

impl<T: clap::Args, S: Send + Sync> FromRequestParts<S> for Words<T> {
    type Rejection = Refused;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Refused> {
        let pairs = Query::<Vec<(String, String)>>::from_request_parts(parts, state).await.map_err(|error| {
            Fault::new(Code::Malformed, error.to_string(), "a query is NAME=VALUE&...", "send one such as ?level=2")
        })?;
        // The token was looked at before.
        Ok(Self(parsed(pairs.0.into_iter().filter(|(name, _)| name != "token"))?))
    }
}

impl<T: clap::Args> IntoParams for Words<T> {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<Parameter> {
        command::<T>().get_arguments().filter_map(described).collect()
    }
}

fn command<T: clap::Args>() -> Command {
    let command = Command::new("").no_binary_name(true).disable_help_flag(true).disable_version_flag(true);
    T::augment_args(command)
}

fn parsed<T: clap::Args>(pairs: impl Iterator<Item = (String, String)>) -> Result<T, Fault> {
    let command = command::<T>();
    let mut words: Vec<(String, String)> = Vec::new();
    for (name, value) in pairs {
        // Both pixel_error and pixel-error.
        let long = name.replace('_', "-");
        let Some(arg) = command.get_arguments().find(|arg| arg.get_long() == Some(&long)) else {
            return Err(unknown(&name, &command));
        };
        if words.iter().any(|(known, _)| *known == long) {
            return Err(bad(format!("{name} twice"), "a parameter is given once", "leave one out"));
        }
        let word = match (arg.get_action(), value.as_str()) {
            (ArgAction::SetTrue, "" | "1" | "true") => format!("--{long}"),
            (ArgAction::SetTrue, "0" | "false") => continue,
            (ArgAction::SetTrue, _) => {
                return Err(bad(format!("{name}={value}"), "a switch is 1 or 0", format!("send {name}=1")));
            }
            _ => format!("--{long}={value}"),
        };
        words.push((long, word));
    }
    let matches = command.try_get_matches_from(words.into_iter().map(|(_, word)| word));
    matches.and_then(|matches| T::from_arg_matches(&matches)).map_err(|error| refused(&error))
}

fn bad(what: impl Into<String>, rule: impl Into<String>, remedy: impl Into<String>) -> Fault {
    Fault::new(Code::Malformed, what, rule, remedy)
}

fn unknown(name: &str, command: &Command) -> Fault {
    let known: Vec<&str> = command.get_arguments().filter_map(Arg::get_long).collect();
    bad(
        format!("the parameter {name}"),
        format!("the parameters are {}", known.join(", ")),
        "correct its name or leave it out; /v1/openapi.json tells what they mean",
    )
}

/// What the parser said, in words of a query.
fn refused(error: &clap::Error) -> Fault {
    let context = |kind| error.get(kind).map(ContextValue::to_string).unwrap_or_default();
    // `--fov <DEG>` is called fov.
    let name = |text: &str| text.trim_start_matches("--").split([' ', '=']).next().unwrap_or_default().to_owned();
    let first = name(&context(ContextKind::InvalidArg));
    let given = || format!("{first}={}", context(ContextKind::InvalidValue));
    let correct = "correct it; /v1/openapi.json tells what it means";
    match error.kind() {
        ErrorKind::ValueValidation => {
            let rule = std::error::Error::source(error).map_or_else(|| "it can be read".into(), ToString::to_string);
            bad(given(), rule, correct)
        }
        ErrorKind::InvalidValue => bad(given(), format!("it is one of {}", context(ContextKind::ValidValue)), correct),
        ErrorKind::MissingRequiredArgument => {
            bad(format!("no {first}"), format!("{first} is needed"), format!("give {first}=..."))
        }
        ErrorKind::ArgumentConflict => {
            let prior = name(&context(ContextKind::PriorArg));
            bad(format!("{first} and {prior}"), "only one of them can hold", "leave one out")
        }
        _ => bad(error.to_string().trim().replace("--", ""), "a query is one of those in /v1/openapi.json", correct),
    }
}

/// A flag as a parameter of OpenAPI.
fn described(arg: &Arg) -> Option<Parameter> {
    let help = arg.get_help().map(ToString::to_string);
    let value = arg.get_value_names().and_then(|names| names.first()).filter(|_| takes_value(arg));
    let description = match (help, value) {
        (Some(help), Some(value)) => Some(format!("{help}: {value}")),
        (help, _) => help,
    };
    let required = if arg.is_required_set() { Required::True } else { Required::False };
    let parameter = ParameterBuilder::new()
        .name(arg.get_long()?.replace('-', "_"))
        .parameter_in(ParameterIn::Query)
        .required(required)
        .description(description)
        .schema(Some(schema(arg)));
    Some(parameter.build())
}

fn takes_value(arg: &Arg) -> bool {
    !matches!(arg.get_action(), ArgAction::SetTrue)
}

fn schema(arg: &Arg) -> Schema {
    let parser: &ValueParser = arg.get_value_parser();
    let is = |kinds: &[TypeId]| kinds.iter().any(|kind| parser.type_id() == *kind);
    let kind = if !takes_value(arg) {
        Type::Boolean
    } else if is(&[TypeId::of::<f64>(), TypeId::of::<f32>()]) {
        Type::Number
    } else if is(&[TypeId::of::<u32>(), TypeId::of::<u8>()]) {
        Type::Integer
    } else {
        Type::String
    };
    let numeric = matches!(kind, Type::Number | Type::Integer);
    let default = arg.get_default_values().first().and_then(|value| value.to_str()).map(|text| {
        let number = numeric.then(|| serde_json::from_str(text).ok()).flatten();
        number.unwrap_or_else(|| serde_json::Value::from(text))
    });
    let words: Vec<String> = arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
    let object = ObjectBuilder::new().schema_type(kind).default(default.filter(|_| takes_value(arg)));
    let object = if words.is_empty() || !takes_value(arg) { object } else { object.enum_values(Some(words)) };
    object.build().into()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;
    use crate::view_args::ViewArgs;

    type Query<'a> = &'a [(&'a str, &'a str)];

    fn view(query: Query<'_>) -> Result<ViewArgs, Fault> {
        parsed(query.iter().map(|&(name, value)| (name.to_owned(), value.to_owned())))
    }

    #[test]
    fn queries_mean_what_the_flags_mean() {
        let asked = view(&[("camera", "-1,2,3"), ("pixel_error", "2.5"), ("soft", "1"), ("sun", "-4,5")]).unwrap();
        assert_eq!((asked.camera.x, asked.pixel_error, asked.soft, asked.size.0), (-1.0, 2.5, true, [1920, 1080]));
        assert!(!view(&[("camera", "1,2,3"), ("soft", "0")]).unwrap().soft);
        assert_eq!(view(&[("camera", "1,2,3"), ("pixel-error", "4")]).unwrap().pixel_error, 4.0);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let cases: &[(Query<'_>, [&str; 2])] = &[
            (&[], ["no camera", "needed"]),
            (&[("camera", "1,2")], ["camera=1,2", "LON,LAT,HEIGHT"]),
            (&[("camera", "1,2,3"), ("zoom", "4")], ["zoom", "pixel-error"]),
            (&[("camera", "1,2,3"), ("help", "")], ["help", "parameters are"]),
            (&[("camera", "1,2,3"), ("camera", "1,2,3")], ["camera twice", "once"]),
            (&[("camera", "1,2,3"), ("scheme", "best")], ["scheme=best", "leb, paper"]),
            (&[("camera", "1,2,3"), ("fov", "wide")], ["fov=wide", "invalid float"]),
            (&[("camera", "1,2,3"), ("soft", "maybe")], ["soft=maybe", "1 or 0"]),
            (&[("camera", "1,2,3"), ("fov", "")], ["fov", ""]),
            (&[("camera", "1,2,3"), ("sun", "1,2"), ("time", "2026-01-01T00:00:00Z")], ["sun and time", "only one"]),
        ];
        for (query, [what, rule]) in cases {
            let fault = view(query).unwrap_err();
            assert!(fault.what.contains(what) && fault.rule.contains(rule), "{query:?}: {fault:?}");
            assert!(!fault.to_string().contains("--"), "{fault}");
        }
    }

    #[test]
    fn flags_describe_themselves() {
        let parameters = Words::<ViewArgs>::into_params(|| None);
        let json = serde_json::to_value(&parameters).unwrap();
        let named = |name: &str| json.as_array().unwrap().iter().find(|p| p["name"] == name).unwrap().clone();
        assert_eq!((&named("camera")["required"], &named("fov")["required"]), (&true.into(), &false.into()));
        assert_eq!(named("fov")["schema"], serde_json::json!({"type": "number", "default": 60}));
        assert_eq!(named("scheme")["schema"]["enum"], serde_json::json!(["leb", "paper"]));
        assert_eq!(named("soft")["schema"]["type"], "boolean");
    }
}
