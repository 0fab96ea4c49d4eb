//! Small files made in the test, with something in every plane.

use relief_formats::body::Body;
use relief_formats::codec::hext::of_nodes;
use relief_formats::codec::nodes::{HALF, interpolate, quarter};
use relief_formats::derive::local_deviation;
use relief_formats::file::writer::{FileSpec, write};
use relief_formats::file::{Entry, Metadata};
use relief_formats::grid::Grid;
use relief_formats::mesh::{MeshLayout, encode_section, patch_mesh};
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_formats::tile_planes::{EncodedTile, TileSamples, encode};

/// A file of mostly flat ground: a plane of m = 8 (one tile), or a globe of m = 9 with both root
/// tiles and two of the eight finer ones.
pub fn small_file(plane: bool) -> Vec<u8> {
    file_with_mesh(plane, if plane { 8 } else { 9 })
}

/// The same with the mesh of an exponent `mesh_m`.
pub fn file_with_mesh(plane: bool, mesh_m: u32) -> Vec<u8> {
    let body = match plane {
        true => Body::Plane { crs_wkt: "x".into(), x0: 1.5, y0: -2.0, dx: 10.0, dy: 10.0 },
        false => Body::moon(),
    };
    let grid = Grid::new(if plane { 8 } else { 9 }, plane);
    let keys: &[(u32, u32, u32)] = if plane { &[(0, 0, 0)] } else { &[(1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 2, 1)] };
    let tiles: Vec<EncodedTile> = keys.iter().map(|&(level, x, y)| tile(TileKey::new(level, x, y), grid)).collect();
    let entries: Vec<Entry> = tiles.iter().map(|tile| tile.entry(0)).collect();
    let metadata = Metadata {
        body: body.clone(),
        vertical: "as given".into(),
        sources: Vec::new(),
        resampling: "none".into(),
        fill: "none".into(),
        bound_m: 0.5,
        versions: Default::default(),
    };
    let mesh = encode_section(&patch_mesh(&body, &Grid::new(mesh_m, plane), MeshLayout::Aligned));
    let spec = FileSpec {
        body: &body,
        m: grid.m,
        step_exponent: 0,
        south_pole_q: 0,
        north_pole_q: 0,
        metadata: &metadata,
        mesh: &mesh,
    };
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("small.relief");
    let append = |k: usize, out: &mut Vec<u8>| {
        tiles[k].planes.iter().for_each(|plane: &Vec<u8>| out.extend_from_slice(plane));
        Ok(())
    };
    write(&path, &spec, &entries, append).expect("a file");
    std::fs::read(&path).expect("its bytes")
}

const NODES: usize = TILE_NODES * TILE_NODES;

/// Flat ground with a hill and a spike, and bounds and deviations beyond what predicts them.
fn tile(key: TileKey, grid: Grid) -> EncodedTile {
    let root = key.level == grid.root_level();
    let nodes = if root { root_nodes() } else { fine_nodes(key.quadrant()) };
    let parent_mean = (!root).then(|| quarter(&means(), key.quadrant()));
    let mut extremes = of_nodes(&nodes);
    extremes.iter_mut().step_by(500).for_each(|e| e.min -= 1);
    let mut deviations = local_deviation(&nodes, TILE_NODES).expect("an odd side");
    deviations[1] += 7;
    let filled: Vec<bool> = (0..NODES).map(|k| k % TILE_NODES > 200 && k / TILE_NODES < 9).collect();
    encode(&TileSamples {
        key,
        root,
        nodes: &nodes,
        mip: &means(),
        parent_mean: parent_mean.as_deref(),
        extremes: &extremes,
        deviations: &deviations,
        filled: &filled,
    })
}

fn root_nodes() -> Vec<i32> {
    let hill = |x: i32, y: i32| (18 - (x - 60).abs().max((y - 60).abs())).max(0);
    let mut nodes: Vec<i32> = (0..NODES).map(|k| hill((k % TILE_NODES) as i32, (k / TILE_NODES) as i32)).collect();
    nodes[70 * TILE_NODES + 50] = 9000;
    nodes
}

/// Nodes below a quarter of the root's: its own, and some new ones that stand out.
fn fine_nodes(quadrant: (usize, usize)) -> Vec<i32> {
    let mut nodes = interpolate(&quarter(&root_nodes(), quadrant), HALF);
    nodes.iter_mut().skip(61 * TILE_NODES).step_by(2).take(100).for_each(|q| *q += 3);
    nodes
}

/// The root's means: true ones inside every quarter, as if all had finer tiles.
fn means() -> Vec<i32> {
    let mut means = root_nodes();
    for (x0, y0) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let fine = fine_nodes((x0, y0));
        for (x, y) in (1..HALF).flat_map(|y| (1..HALF).map(move |x| (x, y))) {
            let weighted = (0..9).map(|k| {
                let (a, b) = (k % 3, k / 3);
                [1, 2, 1][a] * [1, 2, 1][b] * fine[(2 * y + b - 1) * TILE_NODES + 2 * x + a - 1]
            });
            means[(y0 * HALF + y) * TILE_NODES + x0 * HALF + x] = (weighted.sum::<i32>() + 8) >> 4;
        }
    }
    means
}
