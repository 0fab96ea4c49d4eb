//! What a file says where the sources have their own samples: rounding and resampling together.

use rayon::prelude::*;
use relief_formats::file::{FormatError, Relief};
use relief_formats::surface::Place;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

use super::error::Errors;
use crate::bake::Plan;
use crate::source::{Centre, NodeWindow, SourceSet};
use relief_front::error::ToolError;

/// Rows that are read at once.
const ROWS: usize = 64;
/// Corners with less weight do not count: a sample on a node is that node.
const WEIGHTLESS: f64 = 1e-9;
/// Latitudes this close to a pole are the pole.
const POLE_SLACK_DEG: f64 = 1e-6;

/// The sources' samples on a grid, tile by tile; the same for every file on that grid.
pub struct Samples {
    points: Vec<(Place, f64)>,
    /// Every n-th sample of every n-th row was taken.
    pub every: usize,
}

impl Samples {
    /// Collects at most about what `bytes` hold of the samples that no later source overlays.
    ///
    /// # Errors
    /// An input that cannot be decoded.
    pub fn collect(sources: &SourceSet, plan: &Plan, bytes: u64) -> Result<Self, ToolError> {
        let limit = (bytes / size_of::<(Place, f64)>() as u64).max(1) as usize;
        let total: usize = (0..sources.len()).map(|source| sources.size(source)).map(|(nx, ny)| nx * ny).sum();
        let every = (1..).find(|every| total / (every * every) <= limit).unwrap_or(1);
        let mut points = Vec::new();
        for source in (0..sources.len()).filter(|&source| plan.finest[source] == 0) {
            let rows = sources.size(source).1;
            let starts: Vec<usize> = (0..rows).step_by(ROWS * every).collect();
            let bands: Vec<Vec<(Place, f64)>> = starts
                .par_iter()
                .map(|&row| {
                    let centres = sources.centres(source, row..(row + ROWS * every).min(rows), every)?;
                    let placed =
                        centres.iter().filter_map(|centre| Some((place(sources, plan, centre)?, centre.height_m)));
                    Ok(placed.filter(|(place, _)| !overlaid(sources, plan, source, place)).collect())
                })
                .collect::<Result<_, ToolError>>()?;
            points.extend(bands.into_iter().flatten());
        }
        // By all of the place, so that sums do not depend on the threads; shares are positive.
        points.par_sort_unstable_by_key(|(place, _)| {
            (place.tile, place.row, place.column, place.v.to_bits(), place.u.to_bits())
        });
        Ok(Self { points, every })
    }

    /// Memory that they take.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (self.points.capacity() * size_of::<(Place, f64)>()) as u64
    }

    /// How far S_0 is from the samples. Samples beside a filled node are left out.
    ///
    /// # Errors
    /// A tile that cannot be decoded.
    pub fn errors(&self, tiles: &Tiles<'_>) -> Result<Errors, FormatError> {
        let step_m = tiles.relief().step_m();
        let groups: Vec<&[(Place, f64)]> = self.points.chunk_by(|a, b| a.0.tile == b.0.tile).collect();
        let found: Vec<Errors> = groups
            .par_iter()
            .map(|group| {
                let Some(key) = present(tiles.relief(), group)? else { return Ok(Errors::default()) };
                let (nodes, filled) = (tiles.nodes(key)?, tiles.filled(key)?);
                let mut errors = Errors::default();
                for (place, height_m) in *group {
                    let corner = usize::from(place.row) * TILE_NODES + usize::from(place.column);
                    let corners = [corner, corner + 1, corner + TILE_NODES, corner + TILE_NODES + 1];
                    let weights = [(1.0 - place.u) * (1.0 - place.v), place.u * (1.0 - place.v)];
                    let weights = [weights[0], weights[1], (1.0 - place.u) * place.v, place.u * place.v];
                    if corners.iter().zip(weights).any(|(&k, weight)| weight > WEIGHTLESS && filled[k]) {
                        continue;
                    }
                    let [sw, se, nw, ne] = corners.map(|k| f64::from(nodes[k]));
                    let (south, north) = (sw + (se - sw) * place.u, nw + (ne - nw) * place.u);
                    errors.add((south + (north - south) * place.v) * step_m - height_m);
                }
                Ok(errors)
            })
            .collect::<Result<_, FormatError>>()?;
        Ok(found.into_iter().fold(Errors::default(), Errors::and))
    }
}

fn present(relief: &Relief, group: &[(Place, f64)]) -> Result<Option<TileKey>, FormatError> {
    let Some((place, _)) = group.first() else { return Ok(None) };
    Ok(relief.find(place.tile)?.map(|entry| entry.key))
}

/// Where a sample lies on level 0; none outside the grid.
fn place(sources: &SourceSet, plan: &Plan, centre: &Centre) -> Option<Place> {
    if plan.grid.plane {
        return Place::from_xy(&sources.body, plan.grid, 0, centre.x, centre.y).ok();
    }
    let lat_deg = centre.y.clamp(-90.0, 90.0);
    if (lat_deg - centre.y).abs() > POLE_SLACK_DEG {
        return None;
    }
    Place::from_deg(plan.grid, 0, centre.x, lat_deg).ok()
}

/// Whether a later source may have the last word in a place's cell.
fn overlaid(sources: &SourceSet, plan: &Plan, source: usize, place: &Place) -> bool {
    let window = NodeWindow {
        level: 0,
        x0: i64::from(place.tile.x * TILE_CELLS + u32::from(place.column)),
        y0: i64::from(place.tile.y * TILE_CELLS + u32::from(place.row)),
        nx: 2,
        ny: 2,
    };
    (source + 1..sources.len()).any(|later| sources.covers(later, &plan.grid, &window))
}
