//! One module for each command of `relief-bake`: its arguments and what it does.

pub mod bake;
pub mod diff;
pub mod export;
pub mod inspect;
pub mod preview;
pub mod probe;
pub mod report;
pub mod source_args;
pub mod validate;

/// How a command that could run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Exit code 0.
    Good,
    /// Exit code 1: the command ran and found something.
    Found,
}
