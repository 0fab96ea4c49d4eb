//! `GET /v1/planets/{name}/mesh.glb`: what `reliefd render --mesh` writes.

use std::sync::Arc;

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse as _, Response};
use relief_protocol::error::Code;

use super::WaitArgs;
use super::render::{drawn, figures};
use crate::mesh::glb;
use crate::serve::ask::of_tool;
use crate::serve::http::at::At;
use crate::serve::http::off_thread::off_thread;
use crate::serve::http::refused::Refused;
use crate::serve::http::words::Words;
use crate::serve::hub::Hub;
use crate::view_args::ViewArgs;

/// A mesh that is asked for.
#[derive(Debug, clap::Args)]
pub struct MeshArgs {
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    wait: WaitArgs,
}

/// The triangles of a view as binary glTF: metres east, up and south of the camera's foot
///
/// The same headers as a picture has.
#[utoipa::path(
    get,
    path = "/v1/planets/{name}/mesh.glb",
    params(At, Words<MeshArgs>),
    responses((status = 200, description = "Binary glTF", body = Vec<u8>, content_type = "model/gltf-binary"), Refused)
)]
pub async fn mesh(
    State(hub): State<Arc<Hub>>,
    At(served): At,
    Words(args): Words<MeshArgs>,
) -> Result<Response, Refused> {
    let mut picture = drawn(&hub, &served, &args.view, &args.wait, true).await?;
    let figures = figures(&picture);
    let bytes = off_thread(move |_| {
        let triangles = picture.mesh.take().unwrap_or_default();
        glb(&picture.planet, &picture.view.camera, triangles).map_err(|error| of_tool(Code::BadView, &error))
    })
    .await?;
    Ok(([(header::CONTENT_TYPE, "model/gltf-binary")], figures, bytes).into_response())
}
