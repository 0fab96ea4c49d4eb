//! One plane of one level as a raster of the whole map, read by rectangles.
//!
//! Nodes, means, deviations and fills have a sample AT each node: a globe's rows run from pole to
//! pole inclusive, its columns go round once. Extremes have a sample in the middle of each 2 x 2
//! cells.

use rayon::prelude::*;
use relief_formats::derive::decode_deviation;
use relief_formats::file::FormatError;
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

pub use relief_front::window::{Bounds, Rectangle, Samples};

/// What a picture or an export shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PlaneChoice {
    /// Heights of S_0 at the nodes
    Nodes,
    /// Filtered means at the nodes
    Mip,
    /// Least height over 2 x 2 cells
    HextMin,
    /// Greatest height over 2 x 2 cells
    HextMax,
    /// Bound of the distance between S_0 and the mesh without a node
    Deviation,
    /// 1 at nodes that are filled rather than measured, else 0
    Filled,
}

impl PlaneChoice {
    /// True for samples over cells, false for samples at nodes.
    #[must_use]
    pub fn over_cells(self) -> bool {
        matches!(self, Self::HextMin | Self::HextMax)
    }

    /// True for heights on the surface, which may be void.
    #[must_use]
    pub fn is_height(self) -> bool {
        matches!(self, Self::Nodes | Self::Mip)
    }

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Nodes => "nodes",
            Self::Mip => "mip",
            Self::HextMin => "hext-min",
            Self::HextMax => "hext-max",
            Self::Deviation => "deviation",
            Self::Filled => "filled",
        }
    }
}

/// A plane of a level.
#[derive(Clone, Copy)]
pub struct Lattice<'a> {
    tiles: &'a Tiles<'a>,
    level: u32,
    plane: PlaneChoice,
    samples: Samples,
    voids: bool,
}

/// Samples of a tile that no other tile owns, along a side, of a plane over nodes.
const OWN: u32 = 256;

impl<'a> Lattice<'a> {
    /// A plane of `level`, which the grid must have. Where the file says that voids were not
    /// filled, filled nodes read as void (NaN).
    #[must_use]
    pub fn new(tiles: &'a Tiles<'a>, level: u32, plane: PlaneChoice) -> Self {
        let voids = plane.is_height() && tiles.relief().metadata().fill == "none";
        Self { tiles, level, plane, samples: Samples::of(tiles.relief(), level, plane.over_cells()), voids }
    }

    /// The level.
    #[must_use]
    pub fn level(&self) -> u32 {
        self.level
    }

    /// The plane.
    #[must_use]
    pub fn plane(&self) -> PlaneChoice {
        self.plane
    }

    /// True when filled nodes read as void.
    #[must_use]
    pub fn shows_voids(&self) -> bool {
        self.voids
    }

    /// Where its samples lie.
    #[must_use]
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// Samples of a rectangle, row by row, southernmost first; metres, exact in f32. Columns wrap
    /// on a globe; the rectangle must otherwise lie on the map.
    ///
    /// # Errors
    /// A damaged tile.
    pub fn read(&self, rectangle: Rectangle) -> Result<Vec<f32>, FormatError> {
        let Rectangle { column, row, columns, rows } = rectangle;
        let side = if self.plane.over_cells() { OWN / 2 } else { OWN };
        let stride = if self.plane.over_cells() { OWN as usize / 2 } else { TILE_NODES };
        let (first, last) =
            (column.div_euclid(i64::from(side)), (column + i64::from(columns) - 1).div_euclid(i64::from(side)));
        let tiles_x = i64::from(self.samples.columns / side);
        let tiles_y = self.samples.rows / side;
        let mut out = vec![0.0; columns as usize * rows as usize];
        let mut done = 0;
        while done < rows {
            // The northernmost row of nodes has no tiles of its own.
            let y = ((row + done) / side).min(tiles_y - 1);
            let end = if y == tiles_y - 1 { row + rows } else { ((y + 1) * side).min(row + rows) };
            let count = end - (row + done);
            let keys: Vec<i64> = (first..=last).collect();
            let band = keys
                .par_iter()
                .map(|x| self.tile(TileKey::new(self.level, x.rem_euclid(tiles_x) as u32, y)))
                .collect::<Result<Vec<_>, _>>()?;
            for (&x, values) in keys.iter().zip(&band) {
                let start = (x * i64::from(side)).max(column);
                let stop = ((x + 1) * i64::from(side)).min(column + i64::from(columns));
                let n = (stop - start) as usize;
                for k in 0..count {
                    let from = (row + done + k - y * side) as usize * stride + (start - x * i64::from(side)) as usize;
                    let to = (done + k) as usize * columns as usize + (start - column) as usize;
                    out[to..to + n].copy_from_slice(&values[from..from + n]);
                }
            }
            done += count;
        }
        Ok(out)
    }

    /// All samples of a tile.
    fn tile(&self, key: TileKey) -> Result<Vec<f32>, FormatError> {
        let step_m = self.tiles.relief().step_m() as f32;
        let metres = |q: &i32| *q as f32 * step_m;
        let mut values: Vec<f32> = match self.plane {
            PlaneChoice::Nodes => self.tiles.nodes(key)?.iter().map(metres).collect(),
            PlaneChoice::Mip => self.tiles.mip(key)?.iter().map(metres).collect(),
            PlaneChoice::HextMin => self.tiles.extremes(key)?.iter().map(|e| metres(&e.min)).collect(),
            PlaneChoice::HextMax => self.tiles.extremes(key)?.iter().map(|e| metres(&e.max)).collect(),
            PlaneChoice::Filled => self.tiles.filled(key)?.iter().map(|&f| f32::from(u8::from(f))).collect(),
            PlaneChoice::Deviation => match self.tiles.deviations(key)? {
                Some(codes) => codes.iter().map(|&code| decode_deviation(code) * step_m).collect(),
                // An absent tile is never refined.
                None => vec![0.0; TILE_NODES * TILE_NODES],
            },
        };
        if self.voids {
            for (value, filled) in values.iter_mut().zip(self.tiles.filled(key)?) {
                if filled {
                    *value = f32::NAN;
                }
            }
        }
        Ok(values)
    }
}
