//! One case: baked, timed, decoded and compared.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use relief_formats::file::{Plane, Relief};
use relief_formats::mesh::MeshLayout;
use relief_formats::tile::TILE_CELLS;
use relief_formats::tiles::Tiles;

use super::at_nodes;
use super::at_samples::Samples;
use super::error::Errors;
use crate::bake::{BakeOptions, Plan, bake};
use crate::source::{Resample, SourceOptions, open_sources};
use relief_front::error::ToolError;
use relief_front::sheet::folder::Folder;

/// Times that level 0 is decoded, and at most that a file is baked.
pub const RUNS: usize = 3;
/// No further bake of a case begins after so many seconds.
pub const BAKE_S: f64 = 2.0;
/// Tiles that a thread takes at once.
const RUN: usize = 16;
/// Decoded samples that are kept, bytes.
const CACHE_BYTES: u64 = 64 << 20;

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// Heights in steps of 2^k metres.
    pub step_exponent: i8,
    /// The kernel.
    pub resample: Resample,
}

impl Case {
    /// Metres per step.
    #[must_use]
    pub fn step_m(&self) -> f64 {
        f64::from(self.step_exponent).exp2()
    }

    /// The kernel's name on the command line.
    #[must_use]
    pub fn kernel(&self) -> String {
        format!("{:?}", self.resample).to_lowercase()
    }
}

/// What came of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// What was asked for.
    pub case: Case,
    /// Bytes of the whole file.
    pub file_bytes: u64,
    /// Bytes of each plane over all levels, in file order.
    pub plane_bytes: [u64; 5],
    /// Nodes of level 0 in the file, each once.
    pub nodes: u64,
    /// Level-0 nodes against the heights they were rounded from.
    pub at_nodes: Errors,
    /// S_0 against the sources' own samples.
    pub at_samples: Errors,
    /// Median wall time of the bake, reading and resampling included, seconds.
    pub encode_s: f64,
    /// Median wall time of decoding all of level 0, seconds.
    pub decode_s: f64,
}

impl Measured {
    /// Nodes that were read, resampled, derived, encoded and written in a second.
    #[must_use]
    pub fn encode_nodes_per_s(&self) -> f64 {
        self.nodes as f64 / self.encode_s
    }

    /// Nodes decoded in a second.
    #[must_use]
    pub fn decode_nodes_per_s(&self) -> f64 {
        self.nodes as f64 / self.decode_s
    }

    /// Bytes that are no plane's: header, index, mesh and metadata.
    #[must_use]
    pub fn other_bytes(&self) -> u64 {
        self.file_bytes - self.plane_bytes.iter().sum::<u64>()
    }

    /// Bits of the whole file for each node.
    #[must_use]
    pub fn bits_per_node(&self) -> f64 {
        8.0 * self.file_bytes as f64 / self.nodes as f64
    }
}

/// All that the cases of a report share.
pub struct Bench<'a> {
    /// The inputs as they were named.
    pub inputs: &'a [String],
    /// How they are read; the kernel is the case's.
    pub source: &'a SourceOptions,
    /// The grid.
    pub plan: &'a Plan,
    /// The sources' own samples on it.
    pub samples: &'a Samples,
    /// Where files are made.
    pub folder: &'a Folder,
    /// Ends the report at the next block.
    pub stop: &'a AtomicBool,
}

impl Bench<'_> {
    /// Measures a case; `also` sees the file before it goes.
    ///
    /// # Errors
    /// Whatever keeps the file from being baked or read.
    pub fn measure(
        &self,
        case: Case,
        also: impl FnOnce(&Relief) -> Result<(), ToolError>,
    ) -> Result<Measured, ToolError> {
        let output = self.folder.scratch("case.relief");
        let source = SourceOptions { resample: case.resample, ..self.source.clone() };
        let options = BakeOptions {
            output: output.clone(),
            m: Some(self.plan.grid.m),
            step_exponent: Some(case.step_exponent),
            source: source.clone(),
            layout: MeshLayout::Aligned,
            resume: false,
            force: true,
            quiet: true,
        };
        let mut encode_s = Vec::new();
        while encode_s.len() < RUNS && encode_s.iter().sum::<f64>() < BAKE_S {
            let start = Instant::now();
            bake(self.inputs, &options, self.stop)?;
            encode_s.push(start.elapsed().as_secs_f64());
        }
        let of_file = |error| ToolError::of_file(&output)(error);
        let relief = Relief::open(&output).map_err(of_file)?;
        let mut plane_bytes = [0; 5];
        let mut tiles = 0;
        for entry in relief.entries() {
            let entry = entry.map_err(of_file)?;
            tiles += u64::from(entry.key.level == 0);
            for plane in Plane::ALL {
                plane_bytes[plane as usize] += u64::from(entry.lengths[plane as usize]);
            }
        }
        let sources = open_sources(self.inputs, &source)?;
        let decoded = Tiles::new(&relief, CACHE_BYTES);
        let at_nodes = at_nodes::errors(&decoded, &sources, self.plan, of_file)?;
        let at_samples = self.samples.errors(&decoded).map_err(of_file)?;
        let decode_s =
            (0..RUNS).map(|_| decode(&relief, self.source.threads)).collect::<Result<_, _>>().map_err(of_file)?;
        also(&relief)?;
        Ok(Measured {
            case,
            file_bytes: relief.header().file_bytes,
            plane_bytes,
            nodes: tiles * u64::from(TILE_CELLS) * u64::from(TILE_CELLS),
            at_nodes,
            at_samples,
            encode_s: median(encode_s),
            decode_s: median(decode_s),
        })
    }
}

/// Seconds that decoding every level-0 tile takes, coarser tiles as they are needed.
fn decode(relief: &Relief, threads: usize) -> Result<f64, relief_formats::file::FormatError> {
    let entries = at_nodes::finest(relief)?;
    let next = AtomicUsize::new(0);
    let start = Instant::now();
    std::thread::scope(|scope| {
        let work = || {
            let tiles = Tiles::new(relief, CACHE_BYTES).trusting();
            // In file order, so that a thread meets siblings and cousins one after another.
            while let Some(run) = entries.chunks(RUN).nth(next.fetch_add(1, Ordering::Relaxed)) {
                for entry in run {
                    std::hint::black_box(tiles.nodes(entry.key)?);
                }
            }
            Ok(())
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|w| w.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })?;
    Ok(start.elapsed().as_secs_f64())
}

/// The middle one; of an even number the lower.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::median;

    #[test]
    fn medians() {
        assert_eq!((median(vec![3.0, 1.0, 2.0]), median(vec![4.0, 1.0]), median(vec![5.0])), (2.0, 1.0, 5.0));
    }
}
