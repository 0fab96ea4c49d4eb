//! Decoded samples: digests, seams, poles, derived planes, the mesh.

use relief_formats::codec::hext;
use relief_formats::codec::nodes::HALF;
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_tools::validate::{Check, Level, Report};

use super::world::{Tiles, World, hills};
use super::{assert_only, report, report_on};
use crate::common::Folder;

#[test]
fn right_files_have_no_findings() {
    let folder = Folder::new();
    let alps = World::sparse(11, &[(3, 2), (4, 2), (15, 7), (0, 7)]);
    let filled = World { filled: |x, y| x / 40 % 3 == 0 && y > 100, ..World::new(9) };
    for (name, world) in
        [("m8", World::new(8)), ("m9", World::new(9)), ("plane", World::plane(9)), ("sparse", alps), ("filled", filled)]
    {
        let path = folder.path(name);
        world.write(&path, &world.tiles());
        let report = report(&path, Level::Semantic);
        assert_only(&report, &[]);
        assert!(report.good && report.level_reached == Level::Semantic);
    }
}

/// Two stages of derivation, dense: level 4 on comes from summaries.
#[test]
fn a_map_of_two_stages_is_rebuilt() {
    let folder = Folder::new();
    let world = World::new(12);
    let path = folder.path("m12");
    // Made in one stage, which sees the mirrored triangles beyond a pole at the coarsest level,
    // too; there it may be looser, and nowhere else.
    world.write(&path, &world.tiles());
    let report = report(&path, Level::Semantic);
    assert!(report.findings.iter().all(|finding| finding.code == Check::DeviationHigh.code()), "{}", report.text());
    assert!(report.findings.iter().all(|finding| finding.place.lat_deg.unwrap().abs() == 90.0), "{}", report.text());
}

/// The findings on a world whose tiles were changed before they were encoded.
fn changed(world: &World, change: impl Fn(&mut Tiles)) -> Report {
    let folder = Folder::new();
    let mut tiles = world.tiles();
    change(&mut tiles);
    let path = folder.path("x.relief");
    world.write(&path, &tiles);
    report(&path, Level::Semantic)
}

const fn node(x: usize, y: usize) -> usize {
    y * TILE_NODES + x
}

const FINE: TileKey = TileKey::new(0, 1, 0);
const COARSE: TileKey = TileKey::new(1, 0, 0);

#[test]
fn an_edge_that_differs_is_a_torn_seam() {
    let torn = |key: TileKey, at: usize| changed(&World::new(9), |tiles| tiles.get_mut(&key).unwrap().nodes[at] += 2);
    for (key, at) in
        [(FINE, node(256, 33)), (FINE, node(0, 33)), (FINE, node(33, 256)), (TileKey::new(0, 3, 1), node(256, 77))]
    {
        let report = torn(key, at);
        assert!(report.has(Check::Seams), "{}", report.text());
        assert_eq!(report.counts[Check::Seams.code()], 1);
    }
    let seam = torn(TileKey::new(0, 3, 1), node(256, 77));
    let place = &seam.findings[0].place;
    assert_eq!((place.level, place.tile, place.lon_deg), (Some(0), Some([3, 1]), Some(-180.0)));
    assert_eq!(place.lat_deg, Some(180.0 * 77.0 / 512.0));
}

#[test]
fn an_edge_beside_nothing_is_interpolated() {
    let world = World::sparse(9, &[(1, 0)]);
    for at in [node(0, 33), node(256, 33), node(33, 256)] {
        let report = changed(&world, |tiles| tiles.get_mut(&FINE).unwrap().nodes[at] += 1);
        assert!(report.has(Check::AbsentEdges) && !report.has(Check::Seams), "{}", report.text());
    }
}

#[test]
fn a_pole_is_one_node() {
    let south = changed(&World::new(9), |tiles| tiles.get_mut(&FINE).unwrap().nodes[node(33, 0)] += 1);
    assert!(south.has(Check::Poles), "{}", south.text());
    let north =
        changed(&World::new(9), |tiles| tiles.get_mut(&TileKey::new(0, 2, 1)).unwrap().nodes[node(33, 256)] += 1);
    assert!(north.has(Check::Poles), "{}", north.text());
    assert_eq!(north.findings[0].place.lat_deg, Some(90.0));
}

#[test]
fn a_plane_repeats_its_edge() {
    let world = World::plane(9);
    for at in [node(256, 33), node(33, 256)] {
        let report = changed(&world, |tiles| tiles.get_mut(&TileKey::new(0, 1, 1)).unwrap().nodes[at] += 1);
        assert!(report.has(Check::PlaneEdges), "{}", report.text());
        assert!(report.findings[0].place.x.is_some() && report.findings[0].place.lon_deg.is_none());
    }
    let corner = World { height: |x, y, h| hills(x, y + 100, 2 * h) + i32::from((x, y) == (0, 0)), ..World::plane(8) };
    let report = changed(&World::plane(8), |_| ());
    assert_only(&report, &[]);
    let folder = Folder::new();
    let path = folder.path("x.relief");
    corner.write(&path, &World::plane(8).tiles());
    assert_only(&super::report(&path, Level::Semantic), &[Check::PlaneEdges]);
}

#[test]
fn filled_marks_agree_between_tiles_and_levels() {
    let world = World::new(9);
    let seam = changed(&world, |tiles| tiles.get_mut(&FINE).unwrap().filled[node(256, 33)] = true);
    assert_only(&seam, &[Check::FilledSeams]);
    let parent = changed(&world, |tiles| tiles.get_mut(&FINE).unwrap().filled[node(30, 34)] = true);
    assert_only(&parent, &[Check::FilledParent]);
    let own = changed(&world, |tiles| tiles.get_mut(&FINE).unwrap().filled[node(31, 34)] = true);
    assert_only(&own, &[]);
}

#[test]
fn derived_planes_are_rebuilt() {
    let world = World::new(9);
    // Inside a tile the codec binds nodes to the means around them, and a wrong one shows before.
    let mip = changed(&world, |tiles| tiles.get_mut(&COARSE).unwrap().mip[node(0, 34)] += 1);
    assert_only(&mip, &[Check::Mip]);
    let at = 40 * HALF + 50;
    let low = changed(&world, |tiles| {
        let planes = tiles.get_mut(&COARSE).unwrap();
        // The nine nodes of the level are always within; only beyond them can a bound be too tight.
        let own = hext::of_nodes(&planes.nodes);
        let k = (0..HALF * HALF).max_by_key(|&k| planes.extremes[k].max - own[k].max).unwrap();
        assert!(planes.extremes[k].max - own[k].max > 10);
        planes.extremes[k].max = own[k].max;
    });
    assert_only(&low, &[Check::HextInside]);
    let wide = changed(&world, |tiles| tiles.get_mut(&FINE).unwrap().extremes[at].min -= 5000);
    assert_only(&wide, &[Check::HextLoose]);
    assert!(wide.good);
    let low = changed(&world, |tiles| tiles.get_mut(&FINE).unwrap().deviations[node(77, 131)] -= 1);
    assert_only(&low, &[Check::DeviationLow]);
    let high = changed(&world, |tiles| tiles.get_mut(&COARSE).unwrap().deviations[node(77, 131)] += 1);
    assert_only(&high, &[Check::DeviationHigh]);
    assert!(high.good);
    let place = &high.findings[0].place;
    assert_eq!(
        (place.lon_deg, place.lat_deg),
        (Some(-180.0 + 77.0 * 180.0 / 256.0), Some(-90.0 + 131.0 * 180.0 / 256.0))
    );
}

/// A node changed after everything was derived makes all derived planes wrong.
#[test]
fn a_spike_that_was_not_derived_shows_everywhere() {
    let spike = changed(&World::new(9), |tiles| {
        tiles.get_mut(&FINE).unwrap().nodes[node(256, 131)] += 9000;
        tiles.get_mut(&TileKey::new(0, 2, 0)).unwrap().nodes[node(0, 131)] += 9000;
    });
    for check in [Check::Mip, Check::HextInside, Check::DeviationLow] {
        assert!(spike.has(check), "{}", spike.text());
    }
}

#[test]
fn a_wrong_mesh_is_named() {
    use relief_formats::grid::Grid;
    use relief_formats::mesh::{MeshLayout, PatchMesh, patch_mesh};
    let mesh = |change: fn(&mut PatchMesh)| {
        let mut world = World { height: |_, _, _| 7, ..World::new(9) };
        change(&mut world.mesh);
        changed(&world, |_| ())
    };
    assert_only(&mesh(|_| ()), &[]);
    assert_only(&mesh(|mesh| mesh.indices.swap(60, 61)), &[Check::MeshOrientation, Check::MeshManifold]);
    assert_only(&mesh(|mesh| mesh.s_axis[3] += 1), &[Check::MeshAxis]);
    assert_only(&mesh(|mesh| drop(mesh.indices.drain(..3))), &[Check::MeshClosed, Check::MeshEuler]);
    assert!(mesh(|mesh| mesh.indices[61] = mesh.indices[60]).has(Check::MeshArea));
    let paper =
        mesh(|mesh| *mesh = patch_mesh(&relief_formats::body::Body::earth(), &Grid::new(9, false), MeshLayout::Paper));
    assert_only(&paper, &[]);
    let coarser = mesh(|mesh| {
        *mesh = patch_mesh(&relief_formats::body::Body::earth(), &Grid::new(8, false), MeshLayout::Aligned);
    });
    assert_only(&coarser, &[Check::MeshDecodes]);
    let finer = mesh(|mesh| {
        *mesh = patch_mesh(&relief_formats::body::Body::earth(), &Grid::new(10, false), MeshLayout::Aligned);
        mesh.m = 9;
    });
    assert_only(&finer, &[Check::MeshEqual]);
}

#[test]
fn planes_are_decoded_and_compared() {
    use super::parts::Parts;
    use relief_formats::file::Plane;
    use relief_formats::file::index::{ENTRY_BYTES, Entry};
    use relief_formats::file::section::{INDEX, MESH, TILES};
    let folder = Folder::new();
    let world = World { filled: |x, y| x % 512 > 300 && y % 7 == 0, ..World::new(9) };
    let (_, bytes) = world.good(&folder);
    let with = |change: &dyn Fn(&mut Entry, &mut Vec<u8>)| {
        let mut parts = Parts::of(&bytes);
        let mut tiles = parts.body(TILES).clone();
        let index = parts.body(INDEX);
        let at = 4 * ENTRY_BYTES;
        let mut entry = Entry::decode(&index[at..at + ENTRY_BYTES], &world.grid(), tiles.len() as u64).unwrap();
        change(&mut entry, &mut tiles);
        index[at..at + ENTRY_BYTES].copy_from_slice(&entry.encode());
        *parts.body(TILES) = tiles;
        report_on(&folder, &parts.seal(), Level::Checksum)
    };
    for plane in [0, 2, 3, 4] {
        let report = with(&|entry, _| entry.digests[plane][3] ^= 1);
        assert_only(&report, &[Check::PlaneDigest, Check::ContentId]);
    }
    let broken = with(&|entry, tiles| tiles[entry.offset as usize + 40..][..60].fill(0x5a));
    assert!(broken.has(Check::PlaneDecodes) || broken.has(Check::PlaneDigest), "{}", broken.text());
    let frame = with(&|entry, tiles| {
        let start = entry.range(Plane::Filled).start as usize;
        tiles[start..start + 4].fill(0);
    });
    assert_only(&frame, &[Check::PlaneDecodes]);
    let range = with(&|entry, _| entry.max_q -= 1);
    assert_only(&range, &[Check::TileRange]);
    assert_eq!(range.level_reached, Level::Checksum);
    let mut parts = Parts::of(&bytes);
    parts.body(MESH).truncate(50);
    let report = report_on(&folder, &parts.seal(), Level::Semantic);
    assert_only(&report, &[Check::MeshDecodes]);
}
