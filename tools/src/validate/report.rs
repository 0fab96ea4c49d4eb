//! A validation's outcome, for people, programs and CI systems.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::check::{Check, Level, Severity};
use super::finding::{Finding, Findings, Place};
use crate::junit::{Case, Outcome, document};

/// Differences between a file's heights and its sources'.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SourceDifference {
    /// Largest difference, metres.
    pub max_m: f64,
    /// Where it is.
    #[serde(rename = "where")]
    pub place: Option<Place>,
    /// Root of the mean square, metres.
    pub rms_m: f64,
    /// Nodes compared.
    pub nodes: u64,
    /// Largest difference that rounding to steps explains, metres.
    pub bound_m: f64,
}

/// What a validation found.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The file as it was named.
    pub file: String,
    /// The identity its header claims, hexadecimal; absent where the header is damaged.
    pub content_id: Option<String>,
    /// The level asked for.
    pub level: Level,
    /// The deepest level that was tried; shallower than `level` after damage.
    pub level_reached: Level,
    /// True without errors; warnings do not count.
    pub good: bool,
    /// The first findings of each code.
    pub findings: Vec<Finding>,
    /// How many findings each code has.
    pub counts: BTreeMap<&'static str, u64>,
    /// The comparison with the sources, if it was made.
    pub source: Option<SourceDifference>,
}

impl Report {
    pub(super) fn new(
        path: &Path,
        level: Level,
        level_reached: Level,
        content_id: Option<String>,
        source: Option<SourceDifference>,
        findings: Findings,
    ) -> Self {
        let good = !Level::ALL.iter().any(|&level| findings.any_error(level));
        let (findings, counts) = findings.finish();
        let file = path.display().to_string();
        Self { file, content_id, level, level_reached, good, findings, counts, source }
    }

    /// True when a rule has findings.
    #[must_use]
    pub fn has(&self, check: Check) -> bool {
        self.counts.contains_key(check.code())
    }

    /// One line for each finding listed, and a last one.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (at, finding) in self.findings.iter().enumerate() {
            text.push_str(&format!("{finding}\n"));
            let last = self.findings.get(at + 1).is_none_or(|next| next.code != finding.code);
            let listed = self.findings.iter().filter(|other| other.code == finding.code).count() as u64;
            let all = self.counts.get(finding.code).copied().unwrap_or(listed);
            if last && all > listed {
                text.push_str(&format!("{} ... and {} more\n", finding.code, all - listed));
            }
        }
        if let Some(source) = &self.source {
            let place = source.place.as_ref().map_or_else(String::new, |place| format!(" at {place}"));
            text.push_str(&format!(
                "source: largest difference {:.6} m{place}, RMS {:.6} m over {} nodes, bound {} m\n",
                source.max_m, source.rms_m, source.nodes, source.bound_m
            ));
        }
        let total: u64 = self.counts.values().sum();
        let reached = self.level_reached.name();
        text.push_str(&match (self.good, self.level_reached < self.level) {
            (true, _) if total == 0 => format!("{}: good ({reached})\n", self.file),
            (true, _) => format!("{}: good ({reached}), {total} warnings\n", self.file),
            (false, false) => format!("{}: {total} findings ({reached})\n", self.file),
            (false, true) => {
                format!("{}: {total} findings; stopped after {reached}, deeper levels were not tried\n", self.file)
            }
        });
        text
    }

    /// A JUnit document: one test case for each rule up to the level asked for.
    #[must_use]
    pub fn junit(&self) -> String {
        let cases: Vec<Case> =
            Check::ALL.iter().filter(|check| check.level() <= self.level).map(|&check| self.case(check)).collect();
        document(&self.file, &cases)
    }

    fn case(&self, check: Check) -> Case {
        let count = self.counts.get(check.code()).copied().unwrap_or(0);
        let lines = || {
            let own = self.findings.iter().filter(|finding| finding.code == check.code());
            own.map(ToString::to_string).collect::<Vec<_>>().join("\n")
        };
        let (outcome, note) = if count > 0 && check.severity() == Severity::Error {
            (Outcome::Failed(format!("{count} findings against: {}", check.rule()), lines()), String::new())
        } else if check.level() > self.level_reached {
            (Outcome::Skipped(format!("stopped after level {}", self.level_reached.name())), String::new())
        } else {
            (Outcome::Passed, lines())
        };
        Case {
            class: format!("relief.{}", check.level().name()),
            name: format!("{} {}", check.code(), check.rule()),
            outcome,
            note,
        }
    }
}
