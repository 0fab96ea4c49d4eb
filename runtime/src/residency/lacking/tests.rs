//! A rough globe with coarse, fine and no tiles, in views near and over their borders.

mod checks;
mod codes;
mod sample;

use std::time::Duration;

use relief_formats::surface::{Place, Surface};
use relief_shaders::leb::{Params, ReliefTriangle, tessellate};
use relief_shaders::pages::{BOUND_WORDS, EXTREME_WORDS, Pages, SLOT_MASK, unkey};

use super::*;
use crate::report::measure;
use crate::residency::{Capacity, Ram, Resident};
use crate::view::{Camera, Sun, View};

const MOST: u32 = 1 << 22;
const POINTS: usize = 60_000;

/// Near the borders of the file's tiles, far inside what it lacks, at the seam and a pole.
fn views(planet: &Planet, surface: &Surface<'_>) -> Vec<View> {
    // Longitude, latitude, metres above ground, heading, pitch.
    let places = [
        (-89.95, 3.0, 100.0, 270.0, -8.0),
        (-90.0, 22.5, 60_000.0, 200.0, -50.0),
        (-135.02, 45.01, 5_000.0, 120.0, -20.0),
        (120.3, 20.2, 100.0, 30.0, -12.0),
        (133.0, -41.0, 2.0, 300.0, -5.0),
        (90.0, -10.0, 900_000.0, 90.0, -70.0),
        (179.999, 1.0, 1_000.0, 90.0, -15.0),
        (170.0, -89.9, 3_000.0, 0.0, -25.0),
    ];
    let grid = planet.grid();
    let cells = f64::from(grid.height(0)) / 180.0;
    let view = |(lon, lat, above_m, heading, pitch): (f64, f64, f64, f64, f64)| {
        let place = Place::from_cells(grid, 0, (lon + 180.0) * cells, (lat + 90.0) * cells);
        let ground_m = surface.height_m(&place).unwrap();
        let camera = Camera::over_globe(lon, lat, ground_m + above_m).unwrap().looking(heading, pitch, 0.0);
        View::new(camera, [640, 360], Sun::over(0.0, 0.0).unwrap())
    };
    places.into_iter().map(view).collect()
}

fn mesh(pages: &Pages<'_>, view: &View, planet: &Planet) -> Vec<ReliefTriangle> {
    let view = view.uniform(planet).unwrap();
    let mesh = tessellate(pages, &view, &Params::new(pages.planet, &view, MOST, MOST));
    assert!(!mesh.stats.overflow);
    mesh.triangles
}

/// The mesh of a view once all that it asks for is there.
fn settled(resident: &mut Resident<Ram>, view: &View) -> Vec<ReliefTriangle> {
    let planet = Arc::clone(resident.planet());
    for _ in 0..40 {
        let triangles = mesh(&resident.pages(), view, &planet);
        if resident.ask_seen() == 0 {
            return triangles;
        }
        let progress = resident.update(Duration::from_secs(60));
        assert!(!progress.full, "{progress:?}");
    }
    panic!("the view never had all it asked for");
}

/// The mesh with all codes 0 in pages of tiles that the file lacks.
fn mesh_without_codes(resident: &Resident<Ram>, view: &View) -> Vec<ReliefTriangle> {
    let pages = resident.pages();
    let mut bounds = pages.bounds.to_vec();
    for &[key, word] in pages.table.iter().filter(|entry| entry[0] != relief_shaders::pages::NONE) {
        let (level, x, y) = unkey(key);
        if resident.planet().relief().find(TileKey::new(level, x, y)).unwrap().is_none() {
            let slot = ((word & SLOT_MASK) * BOUND_WORDS) as usize;
            bounds[slot + EXTREME_WORDS as usize..slot + BOUND_WORDS as usize].fill(0);
        }
    }
    mesh(&Pages { bounds: &bounds, ..pages }, view, resident.planet())
}

#[test]
fn no_point_is_further_off_than_the_pixel_error_and_no_edge_is_torn() {
    let planet = sample::planet(sample::absent);
    let surface = Surface::new(planet.relief(), 64 << 20);
    let capacity = Capacity::of_slots(300);
    let mut resident = Resident::new(Arc::clone(&planet), capacity, Ram::new(capacity)).unwrap();
    let (mut beyond, mut torn) = (0, 0);
    for view in views(&planet, &surface) {
        let triangles = settled(&mut resident, &view);
        let error = measure(&planet, &surface, &view, &triangles, POINTS).unwrap();
        println!("{:?}: {} triangles, {} pages, {error:?}", view.camera, triangles.len(), resident.count());
        assert!(error.points > 1000, "{error:?}");
        assert!(error.largest_px <= f64::from(view.pixel_error) * 1.01, "{:?}: {error:?}", view.camera);
        assert_eq!(checks::torn(&triangles), None, "{:?}", view.camera);

        let without = mesh_without_codes(&resident, &view);
        let error = measure(&planet, &surface, &view, &without, POINTS).unwrap();
        beyond += usize::from(error.largest_px > 1.5 * f64::from(view.pixel_error));
        torn += usize::from(checks::torn(&without).is_some());
    }
    assert!(beyond > 2, "without the codes the measure shows it: {beyond}");
    assert!(torn > 0, "codes that are not saturated tear the mesh: {torn}");
}
