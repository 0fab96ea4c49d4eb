//! `GET /healthz`.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use utoipa::ToSchema;

use crate::serve::http::shared::Shared;
use crate::serve::meters::Trouble;

/// How the daemon is.
#[derive(serde::Serialize, ToSchema)]
pub struct Health {
    /// The daemon.
    status: Status,
    /// Its planets.
    planets: Vec<PlanetHealth>,
}

/// The daemon.
#[derive(Clone, Copy, serde::Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It takes work.
    Good,
    /// It takes no new work, and ends.
    Stopping,
}

/// How a planet is.
#[derive(serde::Serialize, ToSchema)]
pub struct PlanetHealth {
    /// The file's stem.
    name: String,
    /// What its viewers see.
    state: Trouble,
    /// What draws it.
    backend: String,
    /// Cameras and tasks that wait for its engine, or may.
    cameras: usize,
}

/// How the daemon and its planets are; 503 while it ends
#[utoipa::path(
    get,
    path = "/healthz",
    responses(
        (status = 200, description = "It takes work", body = Health),
        (status = 503, description = "It ends", body = Health),
    ),
    security(())
)]
pub async fn health(State(Shared { hub, stop, .. }): State<Shared>) -> (StatusCode, Json<Health>) {
    let (code, status) = match stop.begun() {
        false => (StatusCode::OK, Status::Good),
        true => (StatusCode::SERVICE_UNAVAILABLE, Status::Stopping),
    };
    let planets = hub.all().map(|served| PlanetHealth {
        name: served.name.clone(),
        state: hub.meters.trouble(&served.name),
        backend: served.engine.backend().to_owned(),
        cameras: served.engine.load(),
    });
    (code, Json(Health { status, planets: planets.collect() }))
}
