//! Heights at points, in f64 from the file.

use relief_formats::surface::{Place, PointSample};
use relief_protocol::error::{Code, Fault};
use relief_runtime::planet::Planet;

/// What a planet's file says of a place: longitude and latitude in degrees, or X and Y.
///
/// # Errors
/// A place or a level that the file does not have, or a damaged tile.
pub fn sample(planet: &Planet, [x, y]: [f64; 2], level: u32) -> Result<PointSample, Fault> {
    let (relief, grid) = (planet.relief(), planet.grid());
    let coarsest = grid.root_level();
    if level > coarsest {
        return Err(Fault::new(
            Code::BadView,
            format!("level {level}"),
            format!("the file has the levels 0 (finest) to {coarsest}"),
            "ask for one of these levels",
        ));
    }
    let place = match grid.plane {
        true => Place::from_xy(relief.body(), grid, level, x, y),
        false => Place::from_deg(grid, level, x, y),
    };
    let place = place.map_err(|error| {
        let rule = match grid.plane {
            true => "a point is X and Y of the file's CRS, within its square",
            false => "a point is a longitude (any turn) and a latitude (-90 to 90) in degrees",
        };
        Fault::new(Code::BadView, error.to_string(), rule, "correct the coordinates")
    })?;
    planet.surface().sample(&place).map_err(|error| {
        Fault::new(
            Code::Damaged,
            error.to_string(),
            "every tile of a file is as it was published",
            "ask for a coarser level; whoever runs the daemon copies or bakes the file again",
        )
    })
}
