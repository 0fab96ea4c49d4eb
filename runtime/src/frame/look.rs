//! The look that suits a planet.

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;
use relief_shaders::frame::Style;

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
    Ok(Style::of(planet.relief().body(), &heights_m))
}
