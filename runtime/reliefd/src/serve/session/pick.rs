//! What a pixel shows: a picture of one pixel, drawn through it.

use std::time::Duration;

use relief_protocol::error::{Code, Fault};
use relief_protocol::to_server::Pick;
use relief_protocol::to_viewer::{Picked, Place};
use relief_protocol::view::{Overlay, Shadow, View};

use crate::serve::ask::asked;
use crate::serve::engine::{Once, Picture};
use crate::serve::heights::sample;
use crate::serve::hub::Served;

/// A pointer does not wait longer for finer tiles.
const WAIT: Duration = Duration::from_millis(200);

/// Answers a pick of a view.
///
/// # Errors
/// A pixel outside the picture, or a view that shows nothing.
pub async fn picked(served: &Served, client: u64, view: &View, pick: &Pick) -> Result<Picked, Fault> {
    let [width, height] = view.size.map(f64::from);
    if !(0.0..=width).contains(&pick.x) || !(0.0..=height).contains(&pick.y) {
        return Err(Fault::new(
            Code::BadView,
            format!("a pixel at {}, {}", pick.x, pick.y),
            format!("the picture has {width} x {height} pixels"),
            "pick inside of it",
        ));
    }
    let planet = served.planet();
    let whole = asked(view, &planet)?.view;
    let through = whole.camera.through(view.size, [pick.x, pick.y]);
    let [x, y, height_m, ..] = view.six();
    let what = View {
        pose: vec![x, y, height_m, through.heading_deg, through.pitch_deg, through.roll_deg],
        fov: through.fov_deg,
        size: [1, 1],
        overlay: Overlay::None,
        ..view.clone()
    };
    let once = Once { what, mesh: false, places: true, wait: WAIT };
    let picture = served.engine.draw_once(client, once).await?;
    let lit = (view.shadow != Shadow::None).then(|| picture.frame.lit.first().copied().unwrap_or(0));
    // A tile may have to be decoded.
    let place = tokio::task::spawn_blocking(move || place(&picture, lit)).await.map_err(|error| {
        Fault::new(Code::Internal, error.to_string(), "a pick is answered", "tell whoever runs the daemon")
    })?;
    Ok(Picked { camera: pick.camera.clone(), id: pick.id, place: place? })
}

fn place(picture: &Picture, lit: Option<u8>) -> Result<Option<Place>, Fault> {
    let Some(at) = picture.frame.places.as_ref().and_then(|places| places.first()).filter(|at| at.level.is_some())
    else {
        return Ok(None);
    };
    let (planet, fixed) = (&picture.planet, [at.s, at.t]);
    let [x, y] = planet.place_of(fixed);
    let [azimuth, elevation] = picture.view.sun.azimuth_elevation_deg(fixed);
    Ok(Some(Place {
        x,
        y,
        height_m: sample(planet, [x, y], 0)?.height_m,
        distance_m: f64::from(picture.frame.distance_m.first().copied().unwrap_or(0.0)),
        sun_elevation_deg: elevation,
        sun_azimuth_deg: azimuth,
        lit: lit.map(|lit| f64::from(lit) / 255.0),
    }))
}
