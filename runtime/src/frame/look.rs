//! The look that suits a planet.

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;
use relief_front::picture::geoid::egm96_m;
use relief_shaders::frame::Style;
use relief_shaders::frame::sea::SEA_NODES;
use relief_shaders::frame::style::Shore;

use crate::planet::Planet;

/// Tints, light and sky for a planet, by its body and the heights of its coarsest tiles: the same
/// for every view.
///
/// # Errors
/// A damaged tile of the coarsest level.
pub fn style_of(planet: &Planet) -> Result<Style, FormatError> {
    let grid = planet.grid();
    let root = grid.root_level();
    let step_m = planet.uniform().step_m;
    let mut heights_m = Vec::new();
    for x in 0..grid.tiles_x(root) {
        let nodes = planet.tiles().nodes(TileKey::new(root, x, 0))?;
        heights_m.extend(nodes.iter().map(|&q| q as f32 * step_m));
    }
    let mut style = Style::of(planet.relief().body(), &heights_m);
    if style.sea == Shore::Ellipsoid as u32 && stands_on_egm96(planet) {
        style.sea = Shore::Grid as u32;
    }
    Ok(style)
}

/// Sea levels for the look of a planet: of EGM96 where that geoid was added to the heights.
#[must_use]
pub fn sea_of(planet: &Planet) -> Vec<f32> {
    if stands_on_egm96(planet) { egm96_m() } else { vec![0.0; SEA_NODES] }
}

fn stands_on_egm96(planet: &Planet) -> bool {
    planet.relief().metadata().vertical.contains("EGM96")
}
