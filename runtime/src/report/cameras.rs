//! The views that a report measures: from far away to just above the ground.

use relief_formats::file::FormatError;
use relief_formats::grid::Grid;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};

use crate::planet::Planet;
use crate::view::Camera;

/// A named camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// What it is.
    pub name: &'static str,
    /// The camera.
    pub camera: Camera,
}

/// Four views of the place of the coarsest level that stands out most over its neighbours.
///
/// # Errors
/// A damaged tile of the coarsest level.
pub fn shots(planet: &Planet) -> Result<Vec<Shot>, FormatError> {
    let (s, t, height_m) = rugged_place(planet)?;
    // A length to measure views in: a globe's radius, or what would be a plane's.
    let scale_m = match planet.ellipsoid() {
        Some(e) => e.a_m,
        None => planet.spacing_m() * f64::from(planet.grid().height(0)),
    };
    let camera = |above_m: f64, pitch_deg: f64| Camera {
        plane: planet.grid().plane,
        s,
        t,
        height_m: height_m + above_m,
        heading_deg: 30.0,
        pitch_deg,
        roll_deg: 0.0,
        fov_deg: 60.0,
    };
    let down = |above: f64| camera(above * scale_m, -90.0);
    Ok(match planet.grid().plane {
        false => vec![
            Shot { name: "whole body, 3 radii up", camera: down(3.0) },
            Shot { name: "orbit, 0.063 radii up", camera: down(0.0627) },
            Shot { name: "slant, 0.005 radii up", camera: camera(0.005 * scale_m, -15.0) },
            Shot { name: "on foot, 2 m up", camera: camera(2.0, -5.0) },
        ],
        true => vec![
            Shot { name: "whole map, one side up", camera: down(1.0) },
            Shot { name: "slant, 0.05 sides up", camera: camera(0.05 * scale_m, -15.0) },
            Shot { name: "on foot, 2 m up", camera: camera(2.0, -5.0) },
        ],
    })
}

/// The inner node of the coarsest level with the largest difference to its four neighbours, in
/// fixed point, and its height.
fn rugged_place(planet: &Planet) -> Result<(u32, u32, f64), FormatError> {
    let grid: Grid = planet.grid();
    let (root, shift) = (grid.root_level(), 31 - grid.m + grid.root_level());
    let mut best = (-1, 0, 0, 0);
    for x in 0..grid.tiles_x(root) {
        let nodes = planet.tiles().nodes(TileKey::new(root, x, 0))?;
        let margin = TILE_NODES / 8;
        for row in margin..TILE_NODES - margin {
            for column in margin..TILE_NODES - margin {
                let k = row * TILE_NODES + column;
                let around = [k - 1, k + 1, k - TILE_NODES, k + TILE_NODES];
                let rough = around.iter().map(|&n| (nodes[n] - nodes[k]).abs()).max().unwrap_or(0);
                if rough > best.0 {
                    best = (rough, x * TILE_CELLS + column as u32, row as u32, nodes[k]);
                }
            }
        }
    }
    Ok((best.1 << shift, best.2 << shift, f64::from(best.3) * planet.relief().step_m()))
}
