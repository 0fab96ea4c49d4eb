//! Deviation codes of tiles that a file lacks.
//!
//! Such a tile's nodes are interpolated, so S_0 in it has no more than the twist of coarser cells;
//! flat triangles still stray from it. A code here is the lesser of two bounds, each of which holds
//! for all of the node's subtree:
//! - what the file's own rule gives for the bilinear surface over the tile's nodes, and what
//!   rounding adds to it below ([`bounds`]);
//! - the codes of the node's parents, up to those that the file has.
//!
//! So codes are saturated from the file's own tiles down, and no larger than what they refine. On
//! the border of a stored tile the stored code counts, and the centre beside it is raised to it.
//! Nodes that two tiles share get the same code from either.
//!
//! This wants what a bake keeps: a stored tile's neighbours lack at most one level
//! ([`super::closure::within_and_about`] finds where it does not).

mod bounds;
mod surround;

use std::sync::Arc;

use quick_cache::sync::Cache;
use relief_formats::file::FormatError;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

use super::closure;
use crate::planet::Planet;

/// Tiles whose codes are kept: those about a few views, with the levels above.
const KEPT: usize = 128;
/// Nodes from a tile's first to its last.
const LAST: usize = TILE_CELLS as usize;

type Codes = Arc<Vec<u8>>;

/// Codes of tiles, 257 x 257, as [`relief_formats::tiles::Tiles::deviations`] lays them out.
///
/// A draft rests on codes of the next coarser level and codes on drafts of their own level, so
/// threads that wait for each other's never wait in a circle.
pub(super) struct Lacking {
    planet: Arc<Planet>,
    drafts: Cache<TileKey, Codes>,
    codes: Cache<TileKey, Codes>,
}

impl Lacking {
    pub fn new(planet: Arc<Planet>) -> Self {
        Self { planet, drafts: Cache::new(KEPT), codes: Cache::new(KEPT) }
    }

    /// The codes of a tile: the file's, or those that stand for them.
    pub fn codes(&self, key: TileKey) -> Result<Codes, FormatError> {
        self.codes.get_or_insert_with(&key, || match self.planet.tiles().deviations(key)? {
            Some(codes) => Ok(Arc::new(codes)),
            None => self.finished(key).map(Arc::new),
        })
    }

    /// The draft with its side midpoints cut to the centres about them, which are their parents.
    fn finished(&self, key: TileKey) -> Result<Vec<u8>, FormatError> {
        let mut codes = self.draft(key)?.to_vec();
        for (row, column) in odd_pairs() {
            let centre = row * TILE_NODES + column;
            for side in [centre - 1, centre + 1, centre - TILE_NODES, centre + TILE_NODES] {
                codes[side] = codes[side].min(codes[centre]);
            }
        }
        for border in self.borders(key) {
            if self.stored(border.neighbour)? {
                continue;
            }
            let theirs = self.draft(border.neighbour)?;
            for n in (1..LAST).step_by(2) {
                let side = border.index(border.end, n);
                codes[side] = codes[side].min(theirs[border.index(LAST - border.inner(), n)]);
            }
        }
        Ok(codes)
    }

    /// Codes with final centres; side midpoints are not yet cut to them.
    fn draft(&self, key: TileKey) -> Result<Codes, FormatError> {
        self.drafts.get_or_insert_with(&key, || {
            let nodes = surround::nodes(&self.planet, key)?;
            let mut codes = bounds::codes(&nodes, key.level);
            let parents = self.codes(key.parent())?;
            let (east, north) = key.quadrant();
            for (row, column) in odd_pairs() {
                let (x, y) = (east * LAST / 2 + column / 2, north * LAST / 2 + row / 2);
                // Of the cell's corners in the coarser tile those with one odd index.
                let rising = (x + y) % 2 == 0;
                let [a, b] = if rising { [(1, 0), (0, 1)] } else { [(0, 0), (1, 1)] }
                    .map(|(dx, dy)| parents[(y + dy) * TILE_NODES + x + dx]);
                let code = &mut codes[row * TILE_NODES + column];
                *code = (*code).min(a).min(b);
            }
            for border in self.borders(key) {
                if !self.stored(border.neighbour)? {
                    continue;
                }
                let theirs = self.codes(border.neighbour)?;
                for n in (1..LAST).step_by(2) {
                    let code = theirs[border.index(LAST - border.end, n)];
                    let centre = border.index(border.inner(), n);
                    codes[border.index(border.end, n)] = code;
                    codes[centre] = codes[centre].max(code);
                }
            }
            Ok(Arc::new(codes))
        })
    }

    fn stored(&self, key: TileKey) -> Result<bool, FormatError> {
        let relief = self.planet.relief();
        relief.check_whole()?;
        Ok(relief.find(key)?.is_some())
    }

    fn borders(&self, key: TileKey) -> impl Iterator<Item = Border> + use<> {
        let sides = [(-1, 0, true, 0), (1, 0, true, LAST), (0, -1, false, 0), (0, 1, false, LAST)];
        let grid = self.planet.grid();
        sides.into_iter().filter_map(move |(dx, dy, upright, end)| {
            closure::beside(grid, key, dx, dy).map(|neighbour| Border { neighbour, upright, end })
        })
    }
}

/// A side of a tile and the tile beyond it.
struct Border {
    neighbour: TileKey,
    /// True for a column of nodes, false for a row.
    upright: bool,
    /// Which column or row.
    end: usize,
}

impl Border {
    /// The n-th node of a column or row along this side.
    fn index(&self, line: usize, n: usize) -> usize {
        if self.upright { n * TILE_NODES + line } else { line * TILE_NODES + n }
    }

    /// The column or row of the centres beside the border.
    fn inner(&self) -> usize {
        if self.end == 0 { 1 } else { LAST - 1 }
    }
}

/// Rows and columns of the centres.
fn odd_pairs() -> impl Iterator<Item = (usize, usize)> {
    (1..LAST).step_by(2).flat_map(|row| (1..LAST).step_by(2).map(move |column| (row, column)))
}

#[cfg(test)]
mod tests;
