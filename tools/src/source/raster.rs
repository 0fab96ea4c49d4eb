//! A source's pixels in metres: held whole where they fit, else block by block.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::exr_reader::ExrReader;
use super::gdal_reader::GdalReader;
use relief_front::error::ToolError;

/// Where the pixels come from.
pub(crate) enum Reader {
    Gdal(GdalReader),
    Exr(ExrReader),
    /// Nowhere: they are there already.
    Ready,
}

/// A raster of heights, row 0 first as stored.
pub(crate) struct Raster {
    pub path: String,
    pub width: usize,
    pub height: usize,
    reader: Reader,
    threads: usize,
    whole: OnceLock<Arc<Vec<f32>>>,
    loading: Mutex<()>,
    /// Blocks of a raster that may not be held whole.
    blocks: Option<Mutex<BlockCache>>,
    block: (usize, usize),
}

/// A block's pixels, shared with whoever copies from them.
type Block = Arc<Vec<f32>>;

/// The least recently used blocks go first.
struct BlockCache {
    capacity: usize,
    clock: u64,
    held: HashMap<(usize, usize), (u64, Block)>,
}

/// A rectangle of a raster's pixels by row and column lists.
pub(crate) struct Patch {
    pub nx: usize,
    pub pixels: Vec<f32>,
}

impl Raster {
    /// A raster that may hold `budget_bytes` of its pixels.
    pub fn new(path: &str, size: (usize, usize), reader: Reader, budget_bytes: u64, threads: usize) -> Self {
        let (width, height) = size;
        let natural = match &reader {
            Reader::Gdal(gdal) => gdal.block,
            _ => size,
        };
        // Thin strips are read several at a time, and no block is more than a few MiB.
        let bx = natural.0.clamp(1, width);
        let by = natural.1.clamp(1, height);
        let by = (by * (1_usize << 16).div_ceil(bx * by)).min(height);
        let whole_fits = (width as u64) * (height as u64) * 4 <= budget_bytes;
        let windowed = !whole_fits && matches!(reader, Reader::Gdal(_));
        let capacity = (budget_bytes / (4 * (bx * by) as u64)).max(2) as usize;
        let blocks = windowed.then(|| Mutex::new(BlockCache { capacity, clock: 0, held: HashMap::new() }));
        Self {
            path: path.to_owned(),
            width,
            height,
            reader,
            threads: threads.max(1),
            whole: OnceLock::new(),
            loading: Mutex::new(()),
            blocks,
            block: (bx, by),
        }
    }

    /// A raster of heights that are there already, `size.0` a row.
    pub fn ready(path: &str, size: (usize, usize), pixels: Vec<f32>) -> Self {
        let raster = Self::new(path, size, Reader::Ready, u64::MAX, 1);
        raster.whole.get_or_init(|| Arc::new(pixels));
        raster
    }

    /// Copies the pixels at `rows` x `columns`. A row marked as turned takes its columns half a
    /// turn on, `half_turn` samples in a circle of `2 half_turn`.
    ///
    /// # Errors
    /// [`ToolError::Source`] when the file cannot be decoded.
    pub fn gather(&self, rows: &[(usize, bool)], columns: &[usize], turn: Option<usize>) -> Result<Patch, ToolError> {
        let mut pixels = Vec::with_capacity(rows.len() * columns.len());
        let straight = runs(columns);
        let turned: Vec<usize> = match turn {
            Some(period) => columns.iter().map(|column| (column + period / 2) % period).collect(),
            None => columns.to_vec(),
        };
        let turned = if rows.iter().any(|row| row.1) { runs(&turned) } else { Vec::new() };
        if self.blocks.is_none() {
            let whole = self.whole()?;
            for &(row, is_turned) in rows {
                let line = &whole[row * self.width..][..self.width];
                for &(start, len) in if is_turned { &turned } else { &straight } {
                    pixels.extend_from_slice(&line[start..start + len]);
                }
            }
        } else {
            let mut near = HashMap::new();
            for &(row, is_turned) in rows {
                for &(start, len) in if is_turned { &turned } else { &straight } {
                    self.extend_from_blocks(&mut near, row, start, len, &mut pixels)?;
                }
            }
        }
        Ok(Patch { nx: columns.len(), pixels })
    }

    /// All pixels, read at first use.
    ///
    /// # Errors
    /// [`ToolError::Source`] when the file cannot be decoded or has nothing but voids.
    pub fn whole(&self) -> Result<Arc<Vec<f32>>, ToolError> {
        if let Some(whole) = self.whole.get() {
            return Ok(whole.clone());
        }
        let _one_loads = self.loading.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(whole) = self.whole.get() {
            return Ok(whole.clone());
        }
        let pixels = match &self.reader {
            Reader::Gdal(reader) => self.load(reader)?,
            Reader::Exr(reader) => reader.load()?,
            Reader::Ready => Vec::new(),
        };
        if pixels.iter().all(|height| height.is_nan()) {
            return Err(ToolError::source(
                &self.path,
                format!("all {} pixels are void", pixels.len()),
                "a source has at least one height",
                "check --nodata, --channel and the file's nodata tag",
            ));
        }
        Ok(self.whole.get_or_init(|| Arc::new(pixels)).clone())
    }

    fn load(&self, reader: &GdalReader) -> Result<Vec<f32>, ToolError> {
        let mut pixels = vec![0.0_f32; self.width * self.height];
        let bands = self.height.div_ceil(self.block.1).min(self.threads);
        let rows = self.height.div_ceil(bands).next_multiple_of(self.block.1);
        std::thread::scope(|scope| {
            let readers: Vec<_> = pixels
                .chunks_mut(rows * self.width)
                .enumerate()
                .map(|(at, part)| {
                    let size = (self.width, part.len() / self.width);
                    scope.spawn(move || reader.read((0, at * rows), size, part))
                })
                .collect();
            readers.into_iter().try_for_each(|reader| match reader.join() {
                Ok(outcome) => outcome,
                Err(panic) => std::panic::resume_unwind(panic),
            })
        })?;
        Ok(pixels)
    }

    fn extend_from_blocks(
        &self,
        near: &mut HashMap<(usize, usize), Arc<Vec<f32>>>,
        row: usize,
        start: usize,
        len: usize,
        pixels: &mut Vec<f32>,
    ) -> Result<(), ToolError> {
        let (mut at, end) = (start, start + len);
        while at < end {
            let key = (at / self.block.0, row / self.block.1);
            if near.len() > 64 {
                near.clear();
            }
            let block = match near.get(&key) {
                Some(block) => block,
                None => near.entry(key).or_insert(self.block_at(key)?),
            };
            let x0 = key.0 * self.block.0;
            let nx = self.block.0.min(self.width - x0);
            let line = &block[(row - key.1 * self.block.1) * nx..][..nx];
            let stop = end.min(x0 + nx);
            pixels.extend_from_slice(&line[at - x0..stop - x0]);
            at = stop;
        }
        Ok(())
    }

    fn block_at(&self, key: (usize, usize)) -> Result<Arc<Vec<f32>>, ToolError> {
        let (Some(cache), Reader::Gdal(reader)) = (&self.blocks, &self.reader) else {
            return self.whole();
        };
        if let Some(block) = cache.lock().unwrap_or_else(PoisonError::into_inner).get(key) {
            return Ok(block);
        }
        let (x0, y0) = (key.0 * self.block.0, key.1 * self.block.1);
        let (nx, ny) = (self.block.0.min(self.width - x0), self.block.1.min(self.height - y0));
        let mut pixels = vec![0.0; nx * ny];
        reader.read((x0, y0), (nx, ny), &mut pixels)?;
        let block = Arc::new(pixels);
        cache.lock().unwrap_or_else(PoisonError::into_inner).put(key, block.clone());
        Ok(block)
    }
}

impl BlockCache {
    fn get(&mut self, key: (usize, usize)) -> Option<Arc<Vec<f32>>> {
        self.clock += 1;
        let (used, block) = self.held.get_mut(&key)?;
        *used = self.clock;
        Some(block.clone())
    }

    fn put(&mut self, key: (usize, usize), block: Arc<Vec<f32>>) {
        self.clock += 1;
        if self.held.len() >= self.capacity
            && let Some(oldest) = self.held.iter().min_by_key(|(_, (used, _))| *used).map(|(key, _)| *key)
        {
            self.held.remove(&oldest);
        }
        self.held.insert(key, (self.clock, block));
    }
}

/// Start and length of each stretch of consecutive columns.
fn runs(columns: &[usize]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &column in columns {
        match runs.last_mut() {
            Some((start, len)) if *start + *len == column => *len += 1,
            _ => runs.push((column, 1)),
        }
    }
    runs
}
