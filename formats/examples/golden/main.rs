//! Writes the golden files of the format: `cargo run --release -p relief-formats --example golden`.
//!
//! The files of a released version are written once and read for ever: run this only to add files
//! for a new version, and commit what it writes into tests/golden/VERSION (or the folder given). Each
//! FILE.relief comes with FILE.txt, the lines that every reader must find in it. The seeds of the
//! fuzz targets are made anew too.

mod map;
mod samples;
mod seeds;
mod terrain;

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};

use relief_formats::body::Body;
use relief_formats::file::writer::{FileSpec, write};
use relief_formats::file::{Entry, Metadata, Relief};
use relief_formats::grid::Grid;
use relief_formats::mesh::{self, MeshLayout, patch_mesh};
use relief_formats::tile::TileKey;

use map::Map;
use terrain::Kind;

struct Golden {
    name: &'static str,
    body: Body,
    m: u32,
    step_exponent: i8,
    kind: Kind,
    layout: MeshLayout,
    absent: fn(TileKey) -> bool,
}

fn all() -> [Golden; 4] {
    let plane = Body::Plane { crs_wkt: "LOCAL_CS[\"metres\"]".into(), x0: -1234.5, y0: 5e6 + 0.1, dx: 30.0, dy: 29.9 };
    [
        Golden {
            name: "globe_m8",
            body: Body::earth(),
            m: 8,
            step_exponent: -4,
            kind: Kind::Seas,
            layout: MeshLayout::Aligned,
            absent: |_| false,
        },
        Golden {
            name: "globe_m9_sparse",
            body: Body::mars(),
            m: 9,
            step_exponent: 0,
            kind: Kind::Seas,
            layout: MeshLayout::Aligned,
            absent: |key| [(1, 1), (2, 1), (3, 0)].contains(&(key.x, key.y)) && key.level == 0,
        },
        Golden {
            name: "globe_m10_sparse",
            body: Body::moon(),
            m: 10,
            step_exponent: -1,
            kind: Kind::Rough,
            layout: MeshLayout::Paper,
            absent: |key| match key.level {
                1 => ![(0, 1), (3, 1)].contains(&(key.x, key.y)),
                _ => ![(0, 2), (1, 3), (7, 3)].contains(&(key.x, key.y)),
            },
        },
        Golden {
            name: "plane_m8",
            body: plane,
            m: 8,
            step_exponent: 3,
            kind: Kind::Extremes,
            layout: MeshLayout::Aligned,
            absent: |_| false,
        },
    ]
}

fn main() -> Result<(), Box<dyn Error>> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/golden/1.0");
    let folder = std::env::args_os().nth(1).map_or(default, PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    for golden in all() {
        let path = folder.join(golden.name).with_extension("relief");
        write_one(&golden, &path)?;
        let lines = samples::lines(&Relief::open(&path)?)?;
        std::fs::write(path.with_extension("txt"), lines.join("\n") + "\n")?;
        println!("{} {} bytes", path.display(), std::fs::metadata(&path)?.len());
    }
    seeds::write(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus"))
}

fn write_one(golden: &Golden, path: &Path) -> Result<(), Box<dyn Error>> {
    let grid = Grid::new(golden.m, golden.body.is_plane());
    let map = Map::new(grid, golden.kind, golden.absent);
    let tiles = map.tiles();
    let entries: Vec<Entry> = tiles.iter().map(|tile| tile.entry(0)).collect();
    let metadata = Metadata {
        body: golden.body.clone(),
        vertical: "as given".into(),
        sources: vec![serde_json::json!({ "name": "integer noise" })],
        resampling: "none".into(),
        fill: "none".into(),
        bound_m: f64::from(golden.step_exponent).exp2() / 2.0,
        versions: BTreeMap::from([("format".into(), "1.0".into())]),
    };
    let mesh = mesh::encode_section(&patch_mesh(&golden.body, &grid, golden.layout));
    let spec = FileSpec {
        body: &golden.body,
        m: golden.m,
        step_exponent: golden.step_exponent,
        south_pole_q: map.node(0, 0, 0),
        north_pole_q: map.node(0, grid.width(0) as i32, grid.height(0) as i32),
        metadata: &metadata,
        mesh: &mesh,
    };
    write(path, &spec, &entries, |k, out| {
        tiles[k].planes.iter().for_each(|plane| out.extend_from_slice(plane));
        Ok(())
    })?;
    map.compare(&Relief::open(path)?)
}
