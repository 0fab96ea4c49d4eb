//! A whole level in RAM: nodes and the pyramid of extremes, as flat arrays.

use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};
use std::thread::ScopedJoinHandle;

use rayon::prelude::*;
use relief_formats::file::{FormatError, Relief};
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

use super::exact;
use crate::planet::Planet;

/// The nodes of one level and the extremes of it and all coarser ones. For f32 heights it takes
/// 1.67 times the nodes' bytes.
#[derive(Clone, Debug)]
pub struct Dense {
    level: u32,
    columns: usize,
    rows: usize,
    /// (columns + 1) x (rows + 1) heights in metres, south row first; column W repeats column 0 of
    /// a globe.
    nodes_m: Vec<f32>,
    /// For each level from `level` up: (least, greatest) of 2 x 2 cells.
    extremes_m: Vec<Vec<[f32; 2]>>,
}

impl Dense {
    /// From the nodes of `level`, (columns + 1) x (rows + 1), south row first, in metres.
    ///
    /// # Panics
    /// When the number of nodes is not that of the level.
    #[must_use]
    pub fn from_nodes(planet: &Planet, level: u32, nodes_m: Vec<f32>) -> Self {
        let rows = 1usize << (planet.m - level);
        let columns = rows << (1 - planet.plane);
        assert_eq!(nodes_m.len(), (columns + 1) * (rows + 1), "nodes of level {level}");
        let mut dense = Self { level, columns, rows, nodes_m, extremes_m: Vec::new() };
        let mut finer = dense.finest_extremes();
        for k in 1..=planet.root_level - level {
            let next = coarser_extremes(&finer, columns >> k, rows >> k);
            dense.extremes_m.push(std::mem::replace(&mut finer, next));
        }
        dense.extremes_m.push(finer);
        dense
    }

    /// A level of a file.
    ///
    /// # Errors
    /// A damaged tile.
    pub fn from_tiles(planet: &Planet, tiles: &Tiles<'_>, level: u32) -> Result<Self, FormatError> {
        Ok(Self::from_nodes(planet, level, nodes_of(planet, tiles, level)?))
    }

    /// Columns of cells.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows of cells.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Level of the nodes.
    #[must_use]
    pub fn level(&self) -> u32 {
        self.level
    }

    /// Heights of a row of nodes, metres, columns + 1 of them.
    #[must_use]
    pub fn row_m(&self, y: usize) -> &[f32] {
        &self.nodes_m[y * (self.columns + 1)..][..self.columns + 1]
    }

    /// All nodes, (columns + 1) x (rows + 1) heights in metres, south row first.
    #[must_use]
    pub fn nodes_m(&self) -> &[f32] {
        &self.nodes_m
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        4 * self.nodes_m.len() + self.extremes_m.iter().map(|level| 8 * level.len()).sum::<usize>()
    }

    fn finest_extremes(&self) -> Vec<[f32; 2]> {
        let half = self.columns / 2;
        let mut out = vec![[0.0; 2]; half * (self.rows / 2)];
        out.par_chunks_mut(half).enumerate().for_each(|(y, out)| {
            let rows = [0, 1, 2].map(|d| self.row_m(2 * y + d));
            for (x, out) in out.iter_mut().enumerate() {
                let nine = rows.iter().flat_map(|row| &row[2 * x..2 * x + 3]);
                *out = nine.fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], &h| [a.min(h), b.max(h)]);
            }
        });
        out
    }
}

/// The nodes of a level of a file, (columns + 1) x (rows + 1), south row first, in metres.
///
/// # Errors
/// A damaged tile.
pub fn nodes_of(planet: &Planet, tiles: &Tiles<'_>, level: u32) -> Result<Vec<f32>, FormatError> {
    let step_m = planet.step_m;
    nodes_as(tiles, level, |q| q as f32 * step_m)
}

/// Tiles for reading a level of a file by [`nodes_as`] and nothing else: few are kept.
#[must_use]
pub fn tiles_of_level(relief: &Relief, level: u32) -> Tiles<'_> {
    Tiles::for_level(relief, level, rayon::current_num_threads())
}

/// [`nodes_of`] as what is made of a height in steps.
///
/// # Errors
/// A damaged tile.
pub fn nodes_as<T: Copy + Default + Send>(
    tiles: &Tiles<'_>,
    level: u32,
    of: impl Fn(i32) -> T + Sync,
) -> Result<Vec<T>, FormatError> {
    let grid = tiles.relief().grid();
    let (columns, rows) = (grid.width(level) as usize, grid.height(level) as usize);
    let stride = columns + 1;
    let mut nodes = vec![T::default(); stride * (rows + 1)];
    let side = TILE_CELLS as usize;
    let read = |(band, out): (usize, &mut [T])| {
        // The northern edge belongs to the last row of tiles.
        let y = band.min(grid.tiles_y(level) as usize - 1);
        for x in 0..grid.tiles_x(level) as usize {
            let samples = tiles.nodes_once(TileKey::new(level, x as u32, y as u32))?;
            for (row, out) in out.chunks_mut(stride).enumerate() {
                let row = row + (band - y) * side;
                let samples = &samples[row * TILE_NODES..][..TILE_NODES];
                for (out, &q) in out[x * side..][..TILE_NODES].iter_mut().zip(samples) {
                    *out = of(q);
                }
            }
        }
        Ok(())
    };
    // One row of tiles after the other: neighbours share the tiles they are decoded from. On threads
    // of its own, since an allocator gives back what decoding took only when a thread ends.
    let bands = Mutex::new(nodes.chunks_mut(stride * side).enumerate());
    let next = || bands.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || std::iter::from_fn(next).try_for_each(read);
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..rayon::current_num_threads()).map(|_| scope.spawn(work)).collect();
        let end = |worker: ScopedJoinHandle<'_, _>| worker.join().unwrap_or_else(|panic| resume_unwind(panic));
        workers.into_iter().map(end).fold(Ok(()), Result::and)
    })?;
    Ok(nodes)
}

fn coarser_extremes(finer: &[[f32; 2]], finer_half: usize, finer_rows: usize) -> Vec<[f32; 2]> {
    let (columns, rows) = (finer_half / 2, finer_rows / 2);
    let mut out = vec![[0.0; 2]; columns * rows];
    for (y, out) in out.chunks_mut(columns).enumerate() {
        for (x, out) in out.iter_mut().enumerate() {
            let at = 2 * y * finer_half + 2 * x;
            let four = [finer[at], finer[at + 1], finer[at + finer_half], finer[at + finer_half + 1]];
            *out = four.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], h| [a.min(h[0]), b.max(h[1])]);
        }
    }
    out
}

impl exact::Relief for &Dense {
    fn extremes_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 2]> {
        let k = level.checked_sub(self.level)?;
        let half = self.columns >> (k + 1);
        self.extremes_m.get(k as usize)?.get(y as usize * half + x as usize).copied()
    }

    fn corners_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 4]> {
        let k = level.checked_sub(self.level)?;
        let stride = self.columns + 1;
        let at = (y as usize * stride + x as usize) << k;
        let [east, north] = [1 << k, stride << k];
        let node = |at: usize| self.nodes_m.get(at).copied();
        Some([node(at)?, node(at + east)?, node(at + north)?, node(at + north + east)?])
    }
}
