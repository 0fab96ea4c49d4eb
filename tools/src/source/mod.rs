//! Elevation sources: what the user names, opened, understood and sampled onto nodes.

mod centres;
pub(crate) mod crs;
mod exr_reader;
mod fill;
mod gdal_reader;
mod geoid;
mod georef;
mod heights;
mod lon_lat;
mod open;
mod options;
mod place;
mod plane;
pub(crate) mod quiet;
pub(crate) mod raster;
mod record;
mod sample;

#[cfg(test)]
mod tests;

use std::sync::OnceLock;

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

pub use centres::Centre;
pub use geoid::SeaLevel;
pub use options::{BodyChoice, Fill, Registration, Resample, SourceOptions, Unit, Vertical};
pub use record::SourceRecord;

use crate::resample::axis::Axis;
use crate::resample::cylindrical::Rows;
use crate::resample::projection::Projection;
use relief_front::error::ToolError;

/// A node without data.
pub const VOID: u8 = 0;
/// A node with a height from the source.
pub const DATA: u8 = 1;
/// A node whose height was interpolated over a void, or is the padding of a plane.
pub const FILLED: u8 = 2;

/// A rectangle of nodes of one level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeWindow {
    /// Level of the nodes.
    pub level: u32,
    /// Westernmost column; on a globe any integer, modulo the level's width.
    pub x0: i64,
    /// Southernmost row.
    pub y0: i64,
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
}

impl NodeWindow {
    /// The nodes of a tile.
    #[must_use]
    pub fn of_tile(key: TileKey) -> Self {
        Self {
            level: key.level,
            x0: i64::from(key.x * TILE_CELLS),
            y0: i64::from(key.y * TILE_CELLS),
            nx: TILE_NODES,
            ny: TILE_NODES,
        }
    }
}

/// Heights of a [`NodeWindow`], row by row, south row first.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightBlock {
    /// Metres; 0 where the state is [`VOID`].
    pub height_m: Vec<f32>,
    /// [`VOID`], [`DATA`] or [`FILLED`] of each node.
    pub state: Vec<u8>,
}

/// All inputs of a bake, in the order they were named. Can be used from many threads at once.
pub struct SourceSet {
    /// What the heights stand on.
    pub body: Body,
    sources: Vec<Source>,
    options: SourceOptions,
}

/// One input.
struct Source {
    raster: raster::Raster,
    mapping: Mapping,
    /// Distance between samples, degrees at the equator (plane: level-0 nodes, so 1).
    spacing: f64,
    rule: heights::HeightRule,
    reference: geoid::Reference,
    record: SourceRecord,
    /// The mean of the row at the South and at the North Pole.
    poles: [OnceLock<f64>; 2],
    /// The raster with its voids interpolated, made when the first void is met.
    filled: OnceLock<raster::Raster>,
}

/// How a node's place becomes a place among pixels.
enum Mapping {
    /// Columns are meridians, rows parallels.
    LonLat {
        columns: Axis,
        rows: Rows,
    },
    Projected(Box<Projection>),
    Plane(plane::PlanePlace),
}

/// Opens, understands and orders the inputs. Pixels are read at first use.
///
/// # Errors
/// [`ToolError::Usage`] for options that contradict each other or the inputs,
/// [`ToolError::Source`] for an input that cannot be used, [`ToolError::Io`] for one that cannot
/// be read.
pub fn open_sources(inputs: &[String], options: &SourceOptions) -> Result<SourceSet, ToolError> {
    open::open_all(inputs, options)
}

impl SourceSet {
    /// The smallest m whose node spacing at the equator is no coarser than the finest source; on a
    /// plane the smallest that holds all pixels. At least 8; may exceed what a file can have.
    #[must_use]
    pub fn default_m(&self) -> u32 {
        let whole = self.sources.iter().find_map(|source| match &source.mapping {
            Mapping::Plane(place) => Some(place.whole),
            _ => None,
        });
        if let Some((nx, ny)) = whole {
            return (8..62).find(|m| 1_i64 << m >= nx.max(ny)).unwrap_or(62);
        }
        let finest = self.sources.iter().map(|source| source.spacing).fold(f64::INFINITY, f64::min);
        (8..32).find(|m| open::no_coarser(180.0 / 2f64.powi(*m), finest)).map_or(32, |m| m as u32)
    }

    /// Number of sources.
    #[must_use]
    pub fn len(&self) -> usize {
        self.sources.len()
    }

    /// True without sources; [`open_sources`] never returns such a set.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// The coarsest level whose nodes are no further apart than this source's samples: the first
    /// level it is sampled at. 0 where even the finest nodes are coarser.
    #[must_use]
    pub fn finest_level(&self, source: usize, grid: &Grid) -> u32 {
        self.sources[source].finest_level(grid)
    }

    /// False only if no node of the window can have data from this source.
    #[must_use]
    pub fn covers(&self, source: usize, grid: &Grid, window: &NodeWindow) -> bool {
        self.sources[source].covers(grid, window)
    }

    /// The largest power of two, metres, of which every stored height of every source is a
    /// multiple; none where there is no sensible one (floats, feet, an added geoid).
    #[must_use]
    pub fn native_step_m(&self) -> Option<f64> {
        let steps = self.sources.iter().map(|source| match source.reference {
            geoid::Reference::Geoid(_) => None,
            _ => source.rule.native_step_m(),
        });
        steps.reduce(|a, b| Some(a?.min(b?))).flatten()
    }

    /// What was used, in order.
    #[must_use]
    pub fn describe(&self) -> Vec<SourceRecord> {
        self.sources.iter().map(|source| source.record.clone()).collect()
    }

    /// Heights of one source at the nodes of a window.
    ///
    /// # Errors
    /// [`ToolError::Source`] when the file turns out to be damaged, or void throughout.
    pub fn sample(&self, source: usize, grid: &Grid, window: &NodeWindow) -> Result<HeightBlock, ToolError> {
        let count = window.nx * window.ny;
        let mut block = HeightBlock { height_m: Vec::with_capacity(count), state: Vec::with_capacity(count) };
        self.visit(source, grid, window, |_, height_m, state| {
            block.height_m.extend_from_slice(height_m);
            block.state.extend_from_slice(state);
        })?;
        Ok(block)
    }

    /// As [`SourceSet::sample`], some rows at a time from the south: `visit` is given the first
    /// row, counted from the window's own, and the heights and states of as many rows as they fill.
    ///
    /// # Errors
    /// As [`SourceSet::sample`]; rows may have been visited.
    pub fn visit(
        &self,
        source: usize,
        grid: &Grid,
        window: &NodeWindow,
        visit: impl FnMut(usize, &[f32], &[u8]),
    ) -> Result<(), ToolError> {
        self.sources[source].visit(&self.options, grid, window, visit)
    }
}
