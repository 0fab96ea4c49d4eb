//! Heights at points, in f64 from the file.

use relief_formats::file::FormatError;
use relief_formats::surface::{Place, PlaceError, PointSample};
use relief_protocol::error::{Code, Fault};
use relief_runtime::planet::Planet;

/// What a planet's file says of a place: longitude and latitude in degrees, or X and Y.
///
/// # Errors
/// A place or a level that the file does not have, or a damaged tile.
pub fn sample(planet: &Planet, point: [f64; 2], level: u32) -> Result<PointSample, Fault> {
    check_level(planet, level)?;
    let place = place(planet, point, level).map_err(|error| outside(planet, &error, ""))?;
    planet.surface().sample(&place).map_err(|error| damaged(&error))
}

/// The same of many places, in their order. `goes_on` is asked before each tile.
///
/// # Errors
/// As [`sample`], or what `goes_on` says.
pub fn samples(
    planet: &Planet,
    points: &[[f64; 2]],
    level: u32,
    goes_on: impl Fn() -> Result<(), Fault>,
) -> Result<Vec<PointSample>, Fault> {
    check_level(planet, level)?;
    let places = points.iter().enumerate().map(|(k, &point)| {
        place(planet, point, level)
            .map(|place| (k, place))
            .map_err(|error| outside(planet, &error, &format!("point {k}: ")))
    });
    // Tile by tile, so that each is decoded once.
    let mut places = places.collect::<Result<Vec<_>, Fault>>()?;
    places.sort_unstable_by_key(|(_, place)| place.tile);
    let mut found: Vec<(usize, PointSample)> = Vec::with_capacity(points.len());
    for run in places.chunk_by(|(_, a), (_, b)| a.tile == b.tile) {
        goes_on()?;
        let Some((_, first)) = run.first() else { continue };
        let tile = planet.surface().tile(first.tile).map_err(|error| damaged(&error))?;
        found.extend(run.iter().map(|(k, place)| (*k, tile.sample(place))));
    }
    found.sort_unstable_by_key(|&(k, _)| k);
    Ok(found.into_iter().map(|(_, sample)| sample).collect())
}

/// Refuses a level that the file does not have.
///
/// # Errors
/// [`Code::BadView`].
fn check_level(planet: &Planet, level: u32) -> Result<(), Fault> {
    let coarsest = planet.grid().root_level();
    if level <= coarsest {
        return Ok(());
    }
    Err(Fault::new(
        Code::BadView,
        format!("level {level}"),
        format!("the file has the levels 0 (finest) to {coarsest}"),
        "ask for one of these levels",
    ))
}

fn place(planet: &Planet, [x, y]: [f64; 2], level: u32) -> Result<Place, PlaceError> {
    let grid = planet.grid();
    match grid.plane {
        true => Place::from_xy(planet.relief().body(), grid, level, x, y),
        false => Place::from_deg(grid, level, x, y),
    }
}

fn outside(planet: &Planet, error: &PlaceError, which: &str) -> Fault {
    off_map(planet.grid().plane, format!("{which}{error}"))
}

/// A point that a planet's map does not have.
pub fn off_map(plane: bool, what: String) -> Fault {
    let rule = match plane {
        true => "a point is X and Y of the file's CRS, within its square",
        false => "a point is a longitude (any turn) and a latitude (-90 to 90) in degrees",
    };
    Fault::new(Code::BadView, what, rule, "correct the coordinates")
}

fn damaged(error: &FormatError) -> Fault {
    Fault::new(
        Code::Damaged,
        error.to_string(),
        "every tile of a file is as it was published",
        "ask for a coarser level; whoever runs the daemon copies or bakes the file again",
    )
}
