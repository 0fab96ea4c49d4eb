//! From sources to a published file.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use relief_formats::derive::{Base, Window, padding};
use relief_formats::file::header::Header;
use relief_formats::file::writer::{FileSpec, write};
use relief_formats::file::{FormatError, Metadata};
use relief_formats::mesh::{self, MeshLayout};

use super::compose::Composer;
use super::crown::crowned;
use super::handoff::{Handoff, Handoffs};
use super::journal::{Journal, Placed};
use super::output::{check_output, io_error, work_file};
use super::plan::{BLOCK_LEVELS, Plan};
use super::provenance::{identity, metadata};
use super::stage::{BlockKey, Finished, blocks, finish};
use crate::progress::Progress;
use crate::source::{SourceOptions, SourceSet, open_sources};
use relief_front::error::ToolError;

/// Memory that a block takes while it is worked off.
const BLOCK_BYTES: u64 = 120 << 20;
/// Memory that does not depend on blocks.
const BASE_BYTES: u64 = 100 << 20;
/// Step of sources that have none of their own: 2^-4 m.
const DEFAULT_STEP_EXPONENT: i8 = -4;

/// What to bake and how.
#[derive(Clone, Debug)]
pub struct BakeOptions {
    /// The file to write.
    pub output: PathBuf,
    /// The map exponent; by default that of the finest source.
    pub m: Option<u32>,
    /// Steps of 2^k metres; by default the sources' own.
    pub step_exponent: Option<i8>,
    /// How the inputs are read.
    pub source: SourceOptions,
    /// Layout of the patch mesh.
    pub layout: MeshLayout,
    /// Go on from the work file of an earlier run.
    pub resume: bool,
    /// Replace an existing output.
    pub force: bool,
    /// No progress.
    pub quiet: bool,
}

/// What was baked.
#[derive(Clone, Debug)]
pub struct BakeReport {
    /// The file's header.
    pub header: Header,
    /// Blocks taken over from an earlier run.
    pub resumed_blocks: usize,
}

/// Bakes `inputs` into one file. `stop` ends it at the next block.
///
/// # Errors
/// Whatever keeps the file from being published; then nothing is left but, after an interruption,
/// the work file.
pub fn bake(inputs: &[String], options: &BakeOptions, stop: &AtomicBool) -> Result<BakeReport, ToolError> {
    check_output(&options.output, options.force)?;
    let sources = open_sources(inputs, &options.source)?;
    let step_exponent = options.step_exponent.unwrap_or_else(|| default_step(&sources));
    let plan = Plan::new(&sources, options.m, step_exponent)?;
    let composer = Composer::new(&sources, &plan, options.source.fill)?;
    let metadata = metadata(&sources, &plan, options)?;
    let identity = identity(&metadata, &plan, options)?;
    let mut baker = Baker::start(&plan, &composer, options, &identity, stop)?;
    match baker.run() {
        Ok(()) => {}
        Err(error) => {
            if matches!(error, ToolError::Interrupted) && !baker.tiles.is_empty() {
                baker.journal.keep();
            }
            return Err(error);
        }
    }
    if !baker.measured {
        return Err(ToolError::source(
            inputs.join(", "),
            "no node of the file would hold a measured height",
            "at least one pixel has data and lies on the map",
            "check --nodata, --bounds and the source's extent",
        ));
    }
    let header = baker.publish(&metadata)?;
    Ok(BakeReport { header, resumed_blocks: baker.resumed })
}

struct Baker<'a> {
    plan: &'a Plan,
    composer: &'a Composer<'a>,
    options: &'a BakeOptions,
    stop: &'a AtomicBool,
    journal: Journal,
    tiles: Vec<Placed>,
    done: BTreeMap<(u32, u32, u32), Handoff>,
    crowned: BTreeMap<usize, Vec<u8>>,
    measured: bool,
    resumed: usize,
}

/// What every block of a stage needs.
struct Worker<'a> {
    plan: &'a Plan,
    composer: &'a Composer<'a>,
    stop: &'a AtomicBool,
    below: Option<&'a Handoffs<'a>>,
}

impl Worker<'_> {
    fn block(&self, key: BlockKey) -> Result<Finished, ToolError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(ToolError::Interrupted);
        }
        let core = key.core(self.plan);
        let pad = padding(key.levels(self.plan));
        let (base, filled) = match self.below {
            Some(below) => below.gather(core, pad)?,
            None => {
                let nodes: Window = core.expand(pad).nodes();
                let composed = self.composer.window(key.level, nodes)?;
                (Base { level: key.level, nodes: composed.q, mip: None, below: None }, composed.filled)
            }
        };
        Ok(finish(self.plan, key, base, filled))
    }
}

impl<'a> Baker<'a> {
    fn start(
        plan: &'a Plan,
        composer: &'a Composer<'a>,
        options: &'a BakeOptions,
        identity: &[u8; 32],
        stop: &'a AtomicBool,
    ) -> Result<Self, ToolError> {
        let path = work_file(&options.output);
        let failed = |error| io_error("cannot use the work file", &path, error);
        let mut tiles = Vec::new();
        let mut done = BTreeMap::new();
        let mut measured = false;
        let found = if options.resume {
            Journal::resume(&path, identity, |block| {
                tiles.extend(block.tiles);
                measured |= block.rest.measured;
                done.insert((block.key.level, block.key.x, block.key.y), block.rest.handoff);
            })
            .map_err(failed)?
        } else {
            None
        };
        let journal = match found {
            Some(journal) => journal,
            None => Journal::create(&path, identity).map_err(failed)?,
        };
        let resumed = done.len();
        Ok(Self { plan, composer, options, stop, journal, tiles, done, crowned: BTreeMap::new(), measured, resumed })
    }

    fn run(&mut self) -> Result<(), ToolError> {
        let root = self.plan.grid.root_level();
        let stages: Vec<u32> = (0..=root).step_by(BLOCK_LEVELS as usize).collect();
        let total: usize = stages.iter().map(|&level| blocks(self.plan, level).len()).sum();
        let progress = Progress::new("baking", total as u64, self.options.quiet);
        let threads = self.options.source.threads.max(1) as u64;
        let room = self.options.source.memory_bytes.saturating_sub(BASE_BYTES) * 2 / 3 / BLOCK_BYTES;
        let at_once = threads.min(room).max(1) as usize;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build().map_err(|error| {
            ToolError::usage(format!("--threads {threads}: {error}"), "the system grants the threads", "ask for fewer")
        })?;
        let mut below: Option<Handoffs<'a>> = None;
        for level in stages {
            let keys = blocks(self.plan, level);
            let mut next = Handoffs::new(self.composer, level + BLOCK_LEVELS);
            let (ready, missing): (Vec<_>, Vec<_>) =
                keys.into_iter().partition(|k| self.done.contains_key(&(k.level, k.x, k.y)));
            for key in ready {
                if let Some(handoff) = self.done.remove(&(key.level, key.x, key.y)) {
                    next.insert(key.x as i32, key.y as i32, handoff);
                }
                progress.add(1);
            }
            // While a batch is worked off, the one before it is written; so one more round, without a
            // batch, follows the last, and one that failed.
            let worker = Worker { plan: self.plan, composer: self.composer, stop: self.stop, below: below.as_ref() };
            let mut batches = missing.chunks(at_once);
            let mut finished: Vec<(BlockKey, Finished)> = Vec::new();
            let mut failed = None;
            loop {
                let batch = if failed.is_none() { batches.next().unwrap_or_default() } else { &[] };
                if batch.is_empty() && finished.is_empty() {
                    break;
                }
                let (placed, results) = std::thread::scope(|scope| {
                    let (journal, before) = (&mut self.journal, &finished);
                    let writer = scope.spawn(move || before.iter().map(|(key, f)| journal.append(*key, f)).collect());
                    let results: Vec<Result<Finished, ToolError>> =
                        pool.install(|| batch.par_iter().map(|&key| worker.block(key)).collect());
                    let placed: std::io::Result<Vec<Vec<Placed>>> =
                        writer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                    (placed, results)
                });
                let path = work_file(&self.options.output);
                let placed = placed.map_err(|error| io_error("cannot write the work file", &path, error))?;
                for ((key, block), placed) in finished.drain(..).zip(placed) {
                    self.tiles.extend(placed);
                    self.measured |= block.measured;
                    next.insert(key.x as i32, key.y as i32, block.handoff);
                    progress.add(1);
                }
                for (&key, result) in batch.iter().zip(results) {
                    match result {
                        Ok(block) => finished.push((key, block)),
                        Err(error) => failed = failed.or(Some(error)),
                    }
                }
            }
            if let Some(error) = failed {
                return Err(error);
            }
            below = Some(next);
        }
        let parts: Vec<&Base> = below.iter().flat_map(Handoffs::bases).collect();
        self.crowned = crowned(self.plan.grid, &parts, &mut self.tiles, &self.journal)
            .map_err(|error| io_error("cannot use the work file", &work_file(&self.options.output), error))?;
        Ok(())
    }

    fn publish(&self, metadata: &Metadata) -> Result<Header, ToolError> {
        let grid = self.plan.grid;
        let root = grid.root_level();
        let (w, h) = (grid.width(root) as i32, grid.height(root) as i32);
        let pole = |x: i32, y: i32| -> Result<i32, ToolError> {
            Ok(self.composer.window(root, Window::new(x, y, 1, 1))?.q.at(x, y))
        };
        let last = if grid.plane { w } else { 0 };
        let patch = mesh::patch_mesh(&self.composer.sources.body, &grid, self.options.layout);
        let mesh = mesh::encode_section(&patch);
        let spec = FileSpec {
            body: &self.composer.sources.body,
            m: grid.m,
            step_exponent: self.plan.step_exponent,
            south_pole_q: pole(0, 0)?,
            north_pole_q: pole(last, h)?,
            metadata,
            mesh: &mesh,
        };
        let planes = |n: usize, buffer: &mut Vec<u8>| match self.crowned.get(&n) {
            Some(bytes) => {
                buffer.extend_from_slice(bytes);
                Ok(())
            }
            None => self.journal.read(&self.tiles[n], buffer),
        };
        write(&self.options.output, &spec, &self.tiles, planes).map_err(|error| match error {
            FormatError::Io { action, path, error } => io_error(action, &path, error),
            error => ToolError::of_file(&self.options.output)(error),
        })
    }
}

fn default_step(sources: &SourceSet) -> i8 {
    sources.native_step_m().map_or(DEFAULT_STEP_EXPONENT, |step_m| step_m.log2().round() as i8)
}
