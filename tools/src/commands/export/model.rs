//! The patch mesh with relief heights and a shaded texture.

use std::path::Path;

use relief_formats::body::Body;
use relief_formats::file::section::MESH;
use relief_formats::file::{FormatError, Relief};
use relief_formats::geodesy::node_of;
use relief_formats::mesh::decode_section;
use relief_formats::surface::{Place, Surface};
use relief_formats::tiles::Tiles;

use crate::commands::preview;
use crate::lattice::Bounds;
use relief_front::error::ToolError;
use relief_front::gltf::glb;
use relief_front::picture::png_bytes;
use relief_front::staging::Staging;
use relief_front::stdout::print;

/// Texture columns; more than this and viewers on small devices refuse it.
const TEXTURE: u32 = 2048;
const CACHE_BYTES: u64 = 128 << 20;

/// Writes the .glb.
pub fn write(input: &Path, tiles: &Tiles<'_>, output: &Path, replace: bool) -> Result<(), ToolError> {
    let staging = Staging::beside(output, replace)?;
    let relief = tiles.relief();
    let in_file = ToolError::of_file(input);
    let section = relief.section_bytes(MESH).unwrap_or_default();
    let mesh = decode_section(section).map_err(|error| in_file(FormatError::Damaged(error.to_string())))?;
    let image = preview::shaded(input, tiles, square(relief), TEXTURE.min(relief.grid().width(0)))?;
    let unwritable = |error| ToolError::Io {
        action: "cannot write",
        path: output.to_path_buf(),
        error,
        remedy: "free some space, or choose another output".into(),
    };
    let texture = png_bytes(&image).map_err(unwritable)?;
    let surface = Surface::new(relief, CACHE_BYTES);
    let mut failure = None;
    let height_m = |s, t| {
        vertex_height_m(&surface, s, t).unwrap_or_else(|error| {
            failure.get_or_insert(error);
            f64::NAN
        })
    };
    let name = input.file_stem().map_or_else(|| "relief".into(), |stem| stem.to_string_lossy());
    let bytes = glb(&mesh, relief.body(), &name, Some(&texture), height_m);
    if let Some(error) = failure {
        return Err(in_file(error));
    }
    let bytes = bytes.map_err(|error| {
        ToolError::usage(error.to_string(), "a glb holds finite heights and at most 4 GiB", "export a .tif instead")
    })?;
    std::fs::write(staging.path("model.glb"), &bytes).map_err(unwritable)?;
    let size = staging.publish("model.glb")?;
    print(&format!(
        "{}: {} vertices, {} triangles, texture {} x {}, {size} bytes\n",
        output.display(),
        mesh.vertex_count(),
        mesh.indices.len() / 3,
        image.width,
        image.height,
    ))
}

/// What the texture covers: on a plane the whole square, far edges included.
fn square(relief: &Relief) -> Bounds {
    match *relief.body() {
        Body::Ellipsoid { .. } => Bounds { west: -180.0, south: -90.0, east: 180.0, north: 90.0 },
        Body::Plane { x0, y0, dx, dy, .. } => {
            let side = f64::from(relief.grid().width(0));
            Bounds { west: x0, south: y0, east: x0 + side * dx, north: y0 + side * dy }
        }
    }
}

/// Height of S_0. A vertex on a coarse level's node is read there: those heights are the same,
/// and few tiles need be decoded.
fn vertex_height_m(surface: &Surface<'_>, s: u32, t: u32) -> Result<f64, FormatError> {
    let grid = surface.relief().grid();
    let on_node = |level: &u32| node_of(grid, *level, s).is_some() && node_of(grid, *level, t).is_some();
    let level = (0..=grid.root_level()).rev().find(on_node).unwrap_or(0);
    let place = Place::from_fixed(grid, level, s, t).map_err(|error| FormatError::Damaged(format!("mesh: {error}")))?;
    surface.height_m(&place)
}
