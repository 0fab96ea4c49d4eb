//! A mesh as PLY, binary: what most programs for meshes open.

use std::fs::File;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

use relief_protocol::mesh::Vertex;

/// Writes vertices, east, north and up of the camera in metres, and triangles.
pub fn write(path: &Path, vertices: &[Vertex], indices: &[u32]) -> Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment metres east, north and up of the camera\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        vertices.len(),
        indices.len() / 3
    )?;
    for vertex in vertices {
        let [east, up, south] = vertex.position_m;
        for coordinate_m in [east, -south, up] {
            out.write_all(&coordinate_m.to_le_bytes())?;
        }
    }
    for triangle in indices.chunks_exact(3) {
        out.write_all(&[3])?;
        triangle.iter().try_for_each(|index| out.write_all(&index.to_le_bytes()))?;
    }
    out.flush()
}
