//! What any two readers of a file must agree on, as lines of text.

use std::error::Error;

use relief_formats::codec::hext::of_nodes;
use relief_formats::codec::nodes::SAMPLE_LIMIT;
use relief_formats::file::Relief;
use relief_formats::file::index::{content_id, digest};
use relief_formats::mesh::MeshLayout;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

/// Content id, mesh, the digest of every plane of every tile, present or absent, and heights in
/// units of step 2^(2 m - 62), which are integers at fixed-point coordinates.
pub fn lines(relief: &Relief) -> Result<Vec<String>, Box<dyn Error>> {
    let tiles = Tiles::new(relief, 64 << 20);
    let entries = relief.entries().collect::<Result<Vec<_>, _>>()?;
    let id = content_id(&relief.header().identity_bytes(), entries.iter());
    let mut lines = vec![format!("content_id {}", hex(&id)), format!("mesh {}", mesh_digest(relief)?)];
    let grid = relief.grid();
    let keys = (0..=grid.root_level()).flat_map(|level| {
        (0..grid.tiles_y(level)).flat_map(move |y| (0..grid.tiles_x(level)).map(move |x| TileKey::new(level, x, y)))
    });
    let mut keys: Vec<TileKey> = keys.collect();
    keys.sort();
    for key in keys {
        let TileKey { level, x, y } = key;
        let mut add =
            |plane: &str, bytes: &[u8]| lines.push(format!("{plane} {level} {x} {y} {}", hex(&digest(bytes))));
        let nodes = tiles.nodes(key)?;
        add("nodes", &little_endian(nodes.iter().copied()));
        add("mip", &little_endian(tiles.mip(key)?.iter().copied()));
        let bounds = tiles.extremes(key)?;
        let inside = of_nodes(&nodes).iter().zip(&bounds).all(|(n, b)| b.min <= n.min && n.max <= b.max);
        if !inside || bounds.iter().any(|b| b.min < -SAMPLE_LIMIT || b.max > SAMPLE_LIMIT) {
            return Err(format!("bounds of {key:?} do not bound its nodes").into());
        }
        add("hext", &little_endian(bounds.iter().flat_map(|b| [b.min, b.max])));
        if let Some(codes) = tiles.deviations(key)? {
            add("deviation", &codes);
        }
        let filled = tiles.filled(key)?;
        let byte = |bits: &[bool]| bits.iter().rev().fold(0u8, |byte, &bit| byte << 1 | u8::from(bit));
        add("filled", &filled.chunks(8).map(byte).collect::<Vec<u8>>());
    }
    for (s, t) in points(grid.plane) {
        lines.push(format!("height {s} {t} {}", height(&tiles, s, t)?));
    }
    Ok(lines)
}

/// Corners of the map, then scattered points; a plane's S may be 2^31.
fn points(plane: bool) -> Vec<(u64, u64)> {
    let far = 1u64 << 31;
    let limit = if plane { far + 1 } else { 1 << 32 };
    let scattered = (1..=60).map(|k| (k * 2_654_435_761 % limit, k * 1_640_531_527 % (far + 1)));
    [(0, 0), (limit - 1, far), (limit / 2, far / 2), (1, far - 1)].into_iter().chain(scattered).collect()
}

fn height(tiles: &Tiles<'_>, s: u64, t: u64) -> Result<i128, Box<dyn Error>> {
    let grid = tiles.relief().grid();
    let unit = 1u64 << (31 - grid.m);
    let i = (s / unit).min(u64::from(grid.width(0)) - 1);
    let j = (t / unit).min(u64::from(grid.height(0)) - 1);
    let (f, g) = (i128::from(s - i * unit), i128::from(t - j * unit));
    let cells = u64::from(TILE_CELLS);
    let nodes = tiles.nodes(TileKey::new(0, (i / cells) as u32, (j / cells) as u32))?;
    let (c, r) = ((i % cells) as usize, (j % cells) as usize);
    let q = |c: usize, r: usize| i128::from(nodes[r * TILE_NODES + c]);
    let unit = i128::from(unit);
    let south = (unit - f) * q(c, r) + f * q(c + 1, r);
    let north = (unit - f) * q(c, r + 1) + f * q(c + 1, r + 1);
    Ok((unit - g) * south + g * north)
}

fn mesh_digest(relief: &Relief) -> Result<String, Box<dyn Error>> {
    let mesh = relief.patch_mesh()?;
    let layout = match mesh.layout {
        MeshLayout::Aligned => 0,
        MeshLayout::Paper => 1,
    };
    let words = [layout].into_iter().chain(mesh.s_axis).chain(mesh.t_axis).chain(mesh.indices);
    Ok(hex(&digest(&words.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())))
}

fn little_endian(samples: impl Iterator<Item = i32>) -> Vec<u8> {
    samples.flat_map(i32::to_le_bytes).collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
