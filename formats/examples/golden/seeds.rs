//! Seeds for the fuzz targets: small good files and their pieces.

use std::error::Error;
use std::path::Path;

use relief_formats::file::section::META;
use relief_formats::file::{Plane, Relief};
use relief_formats::mesh;

#[path = "../../tests/hostile/small.rs"]
mod small;

/// Writes the seeds of every target into its folder.
pub fn write(corpus: &Path) -> Result<(), Box<dyn Error>> {
    let put = |target: &str, name: &str, bytes: &[u8]| {
        let folder = corpus.join(target);
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join(name), bytes)
    };
    for (name, plane) in [("plane", true), ("globe", false)] {
        let bytes = small::small_file(plane);
        let relief = Relief::from_bytes(&bytes)?;
        put("open_and_read", name, &bytes)?;
        put("metadata", name, relief.section_bytes(META).unwrap_or_default())?;
        put("mesh", name, &mesh::encode(&relief.patch_mesh()?))?;
        for entry in relief.entries() {
            let entry = entry?;
            let root = entry.key.level == relief.grid().root_level();
            for plane in Plane::ALL {
                // The order of the harness: root nodes, nodes, mip, hext, deviation, filled.
                let kind = plane as u8 + u8::from(!root || plane != Plane::Nodes);
                // In the second byte: flat terrain, and whether the tile is a root.
                let seed = [&[kind, if root { 8 } else { 0 }], relief.plane_bytes(&entry, plane)].concat();
                put("plane_nodes", &format!("{name}_{}_{}", plane.name(), entry.key.level), &seed)?;
            }
        }
    }
    Ok(())
}
