//! Everything a file promises, checked.
//!
//! Four levels, each including those before it: `structure` reads header, tail, sections, index
//! and metadata; `checksum` decodes every plane; `semantic` builds all derived planes again from
//! level 0 and tries seams, poles and the mesh; `source` resamples the rasters once more. An error
//! in `structure` or `checksum` ends the validation after that level: what lies deeper would only
//! repeat it.
//!
//! | codes | level | about |
//! |---|---|---|
//! | RLF-S001 to S016 | structure | header, tail, sections, metadata, index |
//! | RLF-C001 to C005 | checksum | sections, planes, ranges, identity |
//! | RLF-N001 to N011 | semantic | seams, poles, filled nodes, means, H_ext, deviations |
//! | RLF-M001 to M010 | semantic | the patch mesh |
//! | RLF-X001 to X003 | source | heights and marks against the inputs |
//!
//! Each rule with its code and severity is in [`Check`]; a code never changes its meaning.

pub mod check;
mod compare;
mod container;
mod derived;
pub mod finding;
mod index;
mod inputs;
mod map;
mod mesh;
mod planes;
mod progress;
pub mod report;
mod seams;
mod source;
mod summary;

use std::path::Path;

use relief_formats::file::{FormatError, Relief};
use relief_formats::tiles::Tiles;

pub use check::{Check, Level, Severity};
pub use finding::{Finding, Findings, Place};
pub use inputs::Against;
pub use report::{Report, SourceDifference};

use progress::Progress;
use relief_front::error::ToolError;

/// What to check, and with what.
#[derive(Clone, Debug)]
pub struct Options {
    /// The deepest level.
    pub level: Level,
    /// What to compare with at level `source`.
    pub against: Against,
    /// Memory to use, bytes.
    pub memory_bytes: u64,
    /// Findings of each code that are listed.
    pub listed: usize,
    /// No progress on standard error.
    pub quiet: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { level: Level::Semantic, against: Against::default(), memory_bytes: 1 << 30, listed: 100, quiet: true }
    }
}

/// Validates a file. Runs on the current rayon pool.
///
/// # Errors
/// [`ToolError::File`] when the file cannot be read, is no `.relief` at all or needs a newer
/// reader. A damaged file is no error but has findings.
pub fn validate(path: &Path, options: &Options) -> Result<Report, ToolError> {
    let findings = Findings::new(options.listed);
    let mut run = Run { path, options, findings: &findings, content_id: None, source: None };
    let done = run.levels()?;
    let (content_id, source) = (run.content_id, run.source);
    Ok(Report::new(path, options.level, done, content_id, source, findings))
}

struct Run<'a> {
    path: &'a Path,
    options: &'a Options,
    findings: &'a Findings,
    content_id: Option<String>,
    source: Option<SourceDifference>,
}

impl Run<'_> {
    /// Runs level after level; returns the deepest one that was run to its end.
    fn levels(&mut self) -> Result<Level, ToolError> {
        let (findings, options) = (self.findings, self.options);
        let mut bytes = container::Bytes::open(self.path)?;
        let container = container::container(&mut bytes, findings)?;
        if let Some(container) = &container {
            self.content_id = Some(hex(&container.header.content_id));
        }
        let relief = match Relief::open(self.path) {
            Ok(relief) => Some(relief),
            Err(error) => {
                if findings.is_empty() {
                    findings.add(Check::Openable, Place::default(), error.to_string());
                }
                None
            }
        };
        if let Some(relief) = &relief {
            index::index(relief, findings);
        }
        if options.level == Level::Structure {
            return Ok(Level::Structure);
        }
        if let Some(container) = &container {
            let progress = Progress::new("sections", bytes.length, options.quiet);
            container::section_hashes(&mut bytes, container, findings, |n| progress.step(n))?;
        }
        let Some(relief) = relief.filter(|_| !findings.any_error(Level::Structure)) else {
            return Ok(Level::Structure);
        };
        let tiles = Tiles::new(&relief, options.memory_bytes / 4);
        let count = relief.tile_count() as u64;
        let progress = Progress::new("tiles", count, options.quiet);
        planes::planes(&relief, &tiles, findings, || progress.step(1));
        drop(progress);
        if options.level == Level::Checksum || findings.any_error(Level::Checksum) {
            return Ok(Level::Checksum);
        }
        let damaged = |error: FormatError| ToolError::of_file(self.path)(error);
        let tiles = tiles.trusting();
        mesh::mesh(&relief, findings);
        let progress = Progress::new("seams", count, options.quiet);
        seams::seams(&relief, &tiles, findings, || progress.step(1)).map_err(damaged)?;
        drop(progress);
        let map = map::Map::new(&relief, &tiles).map_err(damaged)?;
        let progress = Progress::new("derived", count, options.quiet);
        derived::derived(&map, options.memory_bytes, findings, |n| progress.step(n)).map_err(damaged)?;
        drop(progress);
        if options.level == Level::Source {
            let progress = Progress::new("source", count, options.quiet);
            let difference =
                source::source(&map, &options.against, options.memory_bytes, findings, || progress.step(1))?;
            self.source = Some(difference);
        }
        Ok(options.level)
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
