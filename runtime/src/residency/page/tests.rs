use proptest::prelude::*;
use relief_formats::body::Body;
use relief_formats::derive::decode_deviation;
use relief_formats::grid::Grid;
use relief_shaders::pages::{CELLS, NODES, Pages};

use super::*;
use crate::residency::closure;
use relief_tests::sample_file::{Sample, wavy_q};

/// A globe of three levels with spikes, so that rounding outwards matters.
fn planet() -> Arc<Planet> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.relief");
    let q = |grid: Grid, i: u32, j: u32| {
        wavy_q(grid, i, j) + if (1..grid.height(0)).contains(&j) && i % 61 == 7 && j % 53 == 9 { 90_000 } else { 0 }
    };
    Sample { q, ..Sample::new(Body::earth(), 10) }.write(&path);
    Planet::open(&path).unwrap()
}

#[test]
fn kernels_read_what_the_file_holds() {
    let planet = planet();
    let decoder = Decoder::new(Arc::clone(&planet));
    let uniform = planet.uniform();
    for key in [TileKey::new(2, 1, 0), TileKey::new(1, 3, 1), TileKey::new(0, 5, 2)] {
        let page = decoder.page(key).unwrap();
        let pages = Pages { planet: &uniform, table: &[], heights: &page.heights, bounds: &page.bounds, seen: &[] };
        let codes = planet.tiles().deviations(key).unwrap().unwrap();
        for (row, column) in (0..NODES).flat_map(|row| (0..NODES).map(move |column| (row, column))) {
            let step = 1 << key.level;
            let (i, j) = ((key.x * CELLS + column) * step, (key.y * CELLS + row) * step);
            let q = wavy_q(planet.grid(), i, j);
            let spike =
                if (1..planet.grid().height(0)).contains(&j) && i % 2048 % 61 == 7 && j % 53 == 9 { 90_000 } else { 0 };
            assert_eq!(pages.node_m(0, column, row), (q + spike) as f32 / 16.0);
            let code = codes[(row * NODES + column) as usize];
            // A root page's even nodes hold what the file does not: the levels above it.
            if key.level < 2 || (row | column) & 1 == 1 {
                assert_eq!(pages.deviation_m(0, column, row), decode_deviation(code) / 16.0);
            } else if row % 256 != 0 || column % 256 != 0 {
                assert!(pages.deviation_m(0, column, row) > 0.0);
            }
        }
    }
}

/// Blocks of `fine` whose interval leaves that of the block above it in `coarse`.
fn sticking_out(fine: &[Extremes], coarse: &[Extremes], key: TileKey) -> usize {
    (0..fine.len())
        .filter(|&k| {
            let (x, y) = (key.x as usize % 2 * 128 + k % 128, key.y as usize % 2 * 128 + k / 128);
            let above = coarse[y / 2 * 128 + x / 2];
            fine[k].min < above.min || fine[k].max > above.max
        })
        .count()
}

#[test]
fn bounds_nest_though_the_files_own_do_not() {
    let planet = planet();
    let decoder = Decoder::new(Arc::clone(&planet));
    let grid = planet.grid();
    let mut of_file = 0;
    for level in 0..grid.root_level() {
        for key in closure::level(grid, level) {
            let (fine, coarse) = (decoder.nested(key).unwrap(), decoder.nested(key.parent()).unwrap());
            assert_eq!(sticking_out(&fine, &coarse, key), 0, "{key:?}");
            let [fine, coarse] = [key, key.parent()].map(|key| planet.tiles().extremes(key).unwrap());
            of_file += sticking_out(&fine, &coarse, key);
        }
    }
    assert!(of_file > 0, "the sample shows the reason for the cut");
}

proptest! {
    #[test]
    fn bounds_still_bound(x in 0u32..2048, y in 0u32..1024) {
        thread_local!(static PLANET: (Arc<Planet>, Decoder) = {
            let planet = planet();
            (Arc::clone(&planet), Decoder::new(planet))
        });
        PLANET.with(|(planet, decoder)| {
            // Level-0 extremes are exact, so they must lie within all coarser ones.
            let leaf = planet.tiles().extremes(TileKey::new(0, x / 256, y / 256)).unwrap();
            let e = leaf[(y % 256 / 2 * 128 + x % 256 / 2) as usize];
            for level in 0..=planet.grid().root_level() {
                let (x, y) = (x >> level, y >> level);
                let bounds = decoder.nested(TileKey::new(level, x / 256, y / 256)).unwrap();
                let b = bounds[(y % 256 / 2 * 128 + x % 256 / 2) as usize];
                prop_assert!(b.min <= e.min && b.max >= e.max);
            }
            Ok(())
        })?;
    }
}
