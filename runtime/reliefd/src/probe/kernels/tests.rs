#![allow(clippy::unwrap_used, reason = "a test ends at the first thing that goes wrong")]

use relief_formats::body::Body;
use relief_formats::file::{Plane, Relief};

use super::*;
use relief_tests::sample_file::Sample;

/// A globe of 128 tiles at level 0.
fn write(path: &Path) {
    Sample::new(Body::earth(), 11).write(path);
}

fn kernels(atlas_bytes: u64, path: &Path) -> Kernels {
    let planet = Planet::new(Relief::open(path).unwrap(), 0).unwrap();
    Kernels::within(atlas_bytes, &Backend::Cpu, planet, path).unwrap()
}

fn places() -> Vec<[u32; 2]> {
    let rows = (0..8u32).map(|y| (y << 28) + (3 << 26));
    rows.flat_map(|t| (0..64u32).map(move |x| [(x << 26) + 12_345, t])).collect()
}

const SUN: PointSun = PointSun { sun: [1.0, 0.0, 0.0, 0.0], level: 0, padding: [0; 3] };

#[test]
fn points_whose_tiles_do_not_fit_together_are_answered_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("globe.relief");
    write(&path);
    let [mut wide, mut narrow] = [200 << 20, 30 << 20].map(|atlas_bytes| kernels(atlas_bytes, &path));
    for sun in [Some(&SUN), None] {
        let known = wide.at(0, sun, &places()).unwrap();
        assert_eq!(known.iter().filter(|(_, lit)| lit.is_some()).count(), sun.map_or(0, |_| places().len()));
        assert_eq!(narrow.at(0, sun, &places()).unwrap(), known);
    }
    assert!(wide.part == PART && narrow.part < places().len(), "{} {}", wide.part, narrow.part);
}

/// A coarser tile stands in for a damaged one: its answer is not given.
#[test]
fn damage_on_a_points_way_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("globe.relief");
    write(&path);
    let mut bytes = std::fs::read(&path).unwrap();
    let at = {
        let relief = Relief::from_bytes(&bytes).unwrap();
        let entry = relief.find(TileKey::new(0, 3, 3)).unwrap().unwrap();
        let plane = relief.plane_bytes(&entry, Plane::Deviation);
        plane.as_ptr() as usize - relief.bytes().as_ptr() as usize + plane.len() / 2
    };
    bytes[at] ^= 0x5a;
    std::fs::write(&path, bytes).unwrap();
    let mut kernels = kernels(200 << 20, &path);
    let [good, bad] = [[9 << 28, 3 << 28], [(3 << 28) + 9, (3 << 28) + 9]];
    for sun in [Some(&SUN), None] {
        assert_eq!(kernels.at(0, sun, &[good]).unwrap().len(), 1);
        let error = kernels.at(0, sun, &[good, bad]).unwrap_err().to_string();
        assert!(error.contains("level 0 tile (3, 3)") && error.contains("remedy"), "{error}");
    }
}
