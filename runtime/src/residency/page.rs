//! A tile as the kernels read it.

use std::sync::Arc;

use quick_cache::sync::Cache;
use relief_formats::derive::extremes::Extremes;
use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;
use relief_shaders::pages::{BLOCKS, BOUND_WORDS, EXTREME_WORDS, HEIGHT_WORDS};

use super::lacking::Lacking;
use crate::planet::Planet;

/// Tiles whose bounds are kept, so that finer ones are cut to them without decoding them again.
const KEPT_BOUNDS: usize = 256;

/// The two parts of a slot.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// 257 x 257 heights of S_0's nodes, metres, south row first.
    pub heights: Vec<f32>,
    /// H_ext and deviation codes, laid out as `relief_shaders::pages` says.
    pub bounds: Vec<u32>,
}

/// Makes pages; shared by the worker threads.
pub(super) struct Decoder {
    planet: Arc<Planet>,
    bounds: Cache<TileKey, Arc<Vec<Extremes>>>,
    lacking: Lacking,
}

impl Decoder {
    pub fn new(planet: Arc<Planet>) -> Self {
        let lacking = Lacking::new(Arc::clone(&planet));
        Self { planet, bounds: Cache::new(KEPT_BOUNDS), lacking }
    }

    /// The page of a tile, which below the root level the file need not have.
    pub fn page(&self, key: TileKey) -> Result<Page, FormatError> {
        self.planet.relief().check_whole()?;
        let step_m = self.planet.relief().step_m() as f32;
        let metres = |q: i32| q as f32 * step_m;
        let nodes = self.planet.tiles().nodes(key)?;
        let extremes = self.nested(key)?;
        let codes = match self.planet.tiles().deviations(key)? {
            Some(codes) => codes,
            None => self.lacking.codes(key)?.to_vec(),
        };
        let heights: Vec<f32> = nodes.iter().map(|&q| metres(q)).collect();
        let mut bounds: Vec<u32> =
            extremes.iter().flat_map(|e| [metres(e.min), metres(e.max)]).map(f32::to_bits).collect();
        bounds.extend(
            codes.chunks(4).map(|chunk| chunk.iter().rev().fold(0, |word, &code| (word << 8) | u32::from(code))),
        );
        bounds.resize(BOUND_WORDS as usize, 0);
        debug_assert!(heights.len() == HEIGHT_WORDS as usize && extremes.len() * 2 == EXTREME_WORDS as usize);
        Ok(Page { heights, bounds })
    }

    /// Bounds that lie within those of the coarser level: a file rounds each level outwards on its
    /// own, but both intervals hold S_0, so what they have in common does too.
    fn nested(&self, key: TileKey) -> Result<Arc<Vec<Extremes>>, FormatError> {
        self.bounds.get_or_insert_with(&key, || {
            let mut extremes = self.planet.tiles().extremes(key)?;
            if key.level < self.planet.grid().root_level() {
                let coarser = self.nested(key.parent())?;
                cut(&mut extremes, &coarser, key.quadrant());
            }
            Ok(Arc::new(extremes))
        })
    }
}

/// Cuts a tile's intervals to those of its parent's blocks; a block there is 2 x 2 blocks here.
fn cut(extremes: &mut [Extremes], coarser: &[Extremes], (east, north): (usize, usize)) {
    const SIDE: usize = BLOCKS as usize;
    for (row, line) in extremes.chunks_exact_mut(SIDE).enumerate() {
        let above = &coarser[(north * SIDE / 2 + row / 2) * SIDE + east * SIDE / 2..];
        for (x, e) in line.iter_mut().enumerate() {
            e.min = e.min.max(above[x / 2].min);
            e.max = e.max.min(above[x / 2].max);
        }
    }
}

#[cfg(test)]
mod tests;
