//! `relief-bake validate` on files that are right, and on files that break each of its rules.

mod command;
mod container;
mod parts;
mod samples;
mod source;
mod world;

use std::path::Path;

use relief_tools::validate::{Check, Level, Options, Report, validate};

use crate::common::Folder;

/// Validates down to a level.
fn report(path: &Path, level: Level) -> Report {
    validate(path, &Options { level, ..Options::default() }).unwrap()
}

/// Validates bytes down to a level.
fn report_on(folder: &Folder, bytes: &[u8], level: Level) -> Report {
    let path = folder.path("x.relief");
    std::fs::write(&path, bytes).unwrap();
    report(&path, level)
}

/// The codes a report has, and no others.
fn assert_only(report: &Report, checks: &[Check]) {
    let mut expected: Vec<_> = checks.iter().map(|check| check.code()).collect();
    expected.sort_unstable();
    assert_eq!(report.counts.keys().copied().collect::<Vec<_>>(), expected, "{}", report.text());
}
