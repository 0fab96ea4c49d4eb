//! The surface S_k: heights between the nodes of a level, their bounds, and what is filled.
//!
//! S_k is bilinear in (s, t) over each cell of level k. It is worked out in f64 from the integer
//! samples of the cell's four nodes: S_0 is the file's truth, the coarser ones are what a viewer
//! sees from further away.

mod place;

use std::sync::Arc;

use quick_cache::sync::Cache;

use crate::derive::extremes::Extremes;
use crate::file::{FormatError, Relief};
use crate::tile::{TILE_CELLS, TILE_NODES, TileKey};
use crate::tiles::{Samples, Tiles};

pub use place::{Place, PlaceError};

/// Tiles whose bounds and fill masks are kept, besides the nodes that [`Tiles`] keeps.
const KEPT_MASKS: usize = 64;

/// What a file says of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSample {
    /// Height of S_k along the normal, metres; at a node exactly the stored one.
    pub height_m: f64,
    /// True when any of the cell's four nodes is filled rather than measured.
    pub filled: bool,
    /// Least and greatest height of S_0, metres, over the H_ext cell of the level (2 x 2 of its
    /// cells) that holds the point.
    pub bounds_m: [f64; 2],
}

/// The surface of a file; shared by any number of threads.
pub struct Surface<'a> {
    tiles: Tiles<'a>,
    masks: Cache<TileKey, Masks>,
}

type Masks = (Arc<Vec<Extremes>>, Arc<Vec<bool>>);

impl<'a> Surface<'a> {
    /// The surface of a file, keeping up to `cache_bytes` of decoded samples.
    #[must_use]
    pub fn new(relief: &'a Relief, cache_bytes: u64) -> Self {
        Self::over(Tiles::new(relief, cache_bytes))
    }

    /// The surface that decoded tiles make up.
    #[must_use]
    pub fn over(tiles: Tiles<'a>) -> Self {
        Self { tiles, masks: Cache::new(KEPT_MASKS) }
    }

    /// The file.
    #[must_use]
    pub fn relief(&self) -> &Relief {
        self.tiles.relief()
    }

    /// The file's decoded tiles.
    #[must_use]
    pub fn tiles(&self) -> &Tiles<'a> {
        &self.tiles
    }

    /// Height of S_k at a place of level k, metres.
    ///
    /// # Errors
    /// A damaged tile, or a place of another grid.
    pub fn height_m(&self, place: &Place) -> Result<f64, FormatError> {
        Ok(height_q(&self.tiles.nodes(place.tile)?, place) * self.relief().step_m())
    }

    /// Height, bounds and fill at a place.
    ///
    /// # Errors
    /// A damaged tile, or a place of another grid.
    pub fn sample(&self, place: &Place) -> Result<PointSample, FormatError> {
        Ok(self.tile(place.tile)?.sample(place))
    }

    /// All of a tile that [`SurfaceTile::sample`] needs, for callers with many points in it.
    ///
    /// # Errors
    /// A damaged tile, or a tile of another grid.
    pub fn tile(&self, key: TileKey) -> Result<SurfaceTile, FormatError> {
        let (extremes, filled) = self.masks.get_or_insert_with(&key, || {
            Ok::<_, FormatError>((Arc::new(self.tiles.extremes(key)?), Arc::new(self.tiles.filled(key)?)))
        })?;
        Ok(SurfaceTile { key, nodes: self.tiles.nodes(key)?, extremes, filled, step_m: self.relief().step_m() })
    }
}

/// One tile of a surface.
#[derive(Clone, Debug)]
pub struct SurfaceTile {
    key: TileKey,
    nodes: Samples,
    extremes: Arc<Vec<Extremes>>,
    filled: Arc<Vec<bool>>,
    step_m: f64,
}

impl SurfaceTile {
    /// Which tile.
    #[must_use]
    pub fn key(&self) -> TileKey {
        self.key
    }

    /// Height, bounds and fill at a place of this tile; of another tile's place, only its cell
    /// within the tile counts.
    #[must_use]
    pub fn sample(&self, place: &Place) -> PointSample {
        let (x, y) = (usize::from(place.column), usize::from(place.row));
        let corner = y * TILE_NODES + x;
        let filled = [corner, corner + 1, corner + TILE_NODES, corner + TILE_NODES + 1].iter().any(|&k| self.filled[k]);
        let bounds = self.extremes[y / 2 * (TILE_CELLS as usize / 2) + x / 2];
        PointSample {
            height_m: height_q(&self.nodes, place) * self.step_m,
            filled,
            bounds_m: [bounds.min, bounds.max].map(|q| f64::from(q) * self.step_m),
        }
    }
}

/// Bilinear height in steps: along s on both sides of the cell, then along t.
fn height_q(nodes: &[i32], place: &Place) -> f64 {
    let corner = usize::from(place.row) * TILE_NODES + usize::from(place.column);
    let along = |k: usize| {
        let (west, east) = (f64::from(nodes[k]), f64::from(nodes[k + 1]));
        west + (east - west) * place.u
    };
    let (south, north) = (along(corner), along(corner + TILE_NODES));
    south + (north - south) * place.v
}

#[cfg(test)]
mod tests;
