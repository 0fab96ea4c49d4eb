//! Reliefs to cast shadows on: fractal noise, the real Earth, and the hard cases.

use relief_formats::body::Body;
use relief_formats::geodesy::Ellipsoid;
use relief_shaders::planet::Planet;
use relief_shaders::shadow::dense::Dense;

use relief_shaders::oracle::World;

pub fn earth() -> Option<Ellipsoid> {
    Ellipsoid::of(&Body::earth())
}

pub fn moon() -> Option<Ellipsoid> {
    Ellipsoid::of(&Body::moon())
}

pub fn mars() -> Option<Ellipsoid> {
    Ellipsoid::of(&Body::mars())
}

/// What the kernels are told of a world.
pub fn planet(world: &World) -> Planet {
    let unit = f64::from(31 - world.m).exp2();
    let (a_m, b_m, e2) = world.ellipsoid.map_or((0.0, 0.0, 0.0), |e| (e.a_m, e.b_m, e.e2()));
    let low = world.nodes_m.iter().fold(f32::INFINITY, |a, &b| a.min(b));
    Planet {
        m: world.m,
        plane: u32::from(world.ellipsoid.is_none()),
        root_level: world.m - 8,
        a_m: a_m as f32,
        b_m: b_m as f32,
        e2: e2 as f32,
        step_m: 1.0 / 16.0,
        min_m: low,
        max_m: world.max_m() as f32,
        unit_x_m: (world.spacing_m[0] / unit) as f32,
        unit_y_m: (world.spacing_m[1] / unit) as f32,
        ..Planet::default()
    }
}

pub fn dense(world: &World) -> Dense {
    Dense::from_nodes(&planet(world), 0, world.nodes_m.clone())
}

/// A world with heights from a formula of node (i, j), in sixteenths of a metre; row 0 and row H of
/// a globe are one height each.
pub fn world(
    name: &'static str,
    m: u32,
    ellipsoid: Option<Ellipsoid>,
    spacing_m: [f64; 2],
    height_m: impl Fn(usize, usize) -> f64,
) -> World {
    let globe = ellipsoid.is_some();
    let rows = 1usize << m;
    let columns = rows << u32::from(globe);
    let mut nodes_m = Vec::with_capacity((columns + 1) * (rows + 1));
    for j in 0..=rows {
        for i in 0..=columns {
            let home = if globe { i % columns } else { i.min(columns - 1) };
            let (home, row) = match globe {
                true if j == 0 || j == rows => (0, j),
                true => (home, j),
                false => (home, j.min(rows - 1)),
            };
            nodes_m.push(((height_m(home, row) * 16.0).round() / 16.0) as f32);
        }
    }
    World { name, m, ellipsoid, spacing_m, nodes_m }
}

/// A well mixed number in 0..1 of three indices.
fn mix(x: u64, y: u64, octave: u64) -> f64 {
    let mut v = x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.wrapping_mul(0xc2b2_ae3d_27d4_eb4f) ^ (octave << 56);
    v = (v ^ (v >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    v = (v ^ (v >> 32)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((v ^ (v >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Fractal noise over the unit square, periodic in x, of amplitude about 1: `octaves` layers from
/// 4 cells across, each `gain` times the one before.
pub fn fractal(x: f64, y: f64, octaves: u32, gain: f64) -> f64 {
    let mut sum = 0.0;
    let mut weight = 1.0;
    for octave in 0..octaves {
        let count = 4u64 << octave;
        let (fx, fy) = (x * count as f64, y * count as f64);
        let (i, j) = (fx.floor() as u64, fy.floor() as u64);
        let smooth = |v: f64| v * v * (3.0 - 2.0 * v);
        let (u, v) = (smooth(fx - fx.floor()), smooth(fy - fy.floor()));
        let value = |i: u64, j: u64| mix(i % count, j, u64::from(octave)) - 0.5;
        let south = value(i, j) * (1.0 - u) + value(i + 1, j) * u;
        let north = value(i, j + 1) * (1.0 - u) + value(i + 1, j + 1) * u;
        sum += weight * (south * (1.0 - v) + north * v);
        weight *= gain;
    }
    sum
}

pub fn fractal_globe(name: &'static str, m: u32, ellipsoid: Option<Ellipsoid>, amplitude_m: f64) -> World {
    let (columns, rows) = ((2u64 << m) as f64, (1u64 << m) as f64);
    world(name, m, ellipsoid, [0.0; 2], |i, j| amplitude_m * fractal(i as f64 / columns, j as f64 / rows, m - 1, 0.55))
}

pub fn fractal_plane(m: u32, spacing_m: [f64; 2], amplitude_m: f64) -> World {
    let side = (1u64 << m) as f64;
    world("fractal plane", m, None, spacing_m, |i, j| {
        500.0 + amplitude_m * fractal(i as f64 / side, j as f64 / side, m - 1, 0.5)
    })
}

/// The Earth of ETOPO1 at 1024 x 512, as the nodes of m = 9.
pub fn real_earth(ellipsoid: Option<Ellipsoid>, scale: f64) -> World {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/exr/earth_1024_f32_zip.exr");
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    let samples: Vec<f32> = image.layer_data.channel_data.list[0].sample_data.values_as_f32().collect();
    assert_eq!(samples.len(), 1024 * 512);
    world("ETOPO1", 9, ellipsoid, [0.0; 2], |i, j| scale * f64::from(samples[(511 - j.min(511)) * 1024 + i]))
}

/// Level 0 of a file.
pub fn from_file(path: &str) -> World {
    let relief = relief_formats::file::Relief::open(std::path::Path::new(path)).unwrap();
    let tiles = relief_formats::tiles::Tiles::new(&relief, 64 << 20).trusting();
    let grid = relief.grid();
    let unit_planet = Planet {
        m: grid.m,
        plane: u32::from(grid.plane),
        root_level: grid.root_level(),
        step_m: relief.step_m() as f32,
        ..Planet::default()
    };
    let dense = Dense::from_tiles(&unit_planet, &tiles, 0).unwrap();
    let nodes_m = (0..=dense.rows()).flat_map(|y| dense.row_m(y).to_vec()).collect();
    let spacing_m = match *relief.body() {
        Body::Plane { dx, dy, .. } => [dx, dy],
        Body::Ellipsoid { .. } => [0.0; 2],
    };
    let name = Box::leak(path.to_owned().into_boxed_str());
    World { name, m: grid.m, ellipsoid: Ellipsoid::of(relief.body()), spacing_m, nodes_m }
}
