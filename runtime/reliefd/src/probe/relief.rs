//! Heights and bounds for single rays, from decoded tiles.

use std::collections::HashMap;
use std::sync::Arc;

use relief_formats::derive::extremes::Extremes;
use relief_formats::file::FormatError;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tiles::Samples;
use relief_runtime::planet::Planet;
use relief_shaders::shadow::Relief;

/// Tiles that are held; then all are let go.
const MOST_TILES: usize = 512;
/// Bounds along a tile's side.
const BLOCKS: u32 = TILE_CELLS / 2;

/// What rays over a planet fetch.
pub struct TileRelief {
    planet: Arc<Planet>,
    nodes: HashMap<TileKey, Samples>,
    extremes: HashMap<TileKey, Vec<Extremes>>,
    /// The first tile that did not decode.
    damage: Option<FormatError>,
}

impl TileRelief {
    /// No tiles yet.
    pub fn new(planet: Arc<Planet>) -> Self {
        Self { planet, nodes: HashMap::new(), extremes: HashMap::new(), damage: None }
    }

    /// The damage that a ray met, if it met any.
    pub fn check(&mut self) -> Result<(), FormatError> {
        self.damage.take().map_or(Ok(()), Err)
    }

    fn note<T>(damage: &mut Option<FormatError>, result: Result<T, FormatError>) -> Option<T> {
        result.map_err(|error| damage.get_or_insert(error)).ok()
    }
}

impl Relief for TileRelief {
    fn extremes_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 2]> {
        let key = TileKey::new(level, x / BLOCKS, y / BLOCKS);
        if self.extremes.len() > MOST_TILES {
            self.extremes.clear();
        }
        if !self.extremes.contains_key(&key) {
            let decoded = Self::note(&mut self.damage, self.planet.tiles().extremes(key))?;
            self.extremes.insert(key, decoded);
        }
        let bounds = self.extremes.get(&key)?.get((y % BLOCKS * BLOCKS + x % BLOCKS) as usize)?;
        let step_m = self.planet.uniform().step_m;
        Some([bounds.min as f32 * step_m, bounds.max as f32 * step_m])
    }

    fn corners_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 4]> {
        let key = TileKey::new(level, x / TILE_CELLS, y / TILE_CELLS);
        if self.nodes.len() > MOST_TILES {
            self.nodes.clear();
        }
        if !self.nodes.contains_key(&key) {
            let decoded = Self::note(&mut self.damage, self.planet.tiles().nodes(key))?;
            self.nodes.insert(key, decoded);
        }
        let nodes = self.nodes.get(&key)?;
        let at = (y % TILE_CELLS) as usize * TILE_NODES + (x % TILE_CELLS) as usize;
        let step_m = self.planet.uniform().step_m;
        let corners = [at, at + 1, at + TILE_NODES, at + TILE_NODES + 1];
        Some(corners.map(|at| nodes[at] as f32 * step_m))
    }
}
