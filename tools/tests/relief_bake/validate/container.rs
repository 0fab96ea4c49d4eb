//! Header, tail, sections, index: each rule broken, every byte flipped, files cut.

use relief_formats::file::index::{ENTRY_BYTES, Entry};
use relief_formats::file::section::{INDEX, MESH, META, TILES};
use relief_formats::file::{FormatError, Plane};
use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;
use relief_front::error::ToolError;
use relief_tools::validate::{Check, Level, Options, validate};

use super::parts::Parts;
use super::world::World;
use super::{assert_only, report, report_on};
use crate::common::Folder;

/// Flat but for one bump, so that the file is a few kilobytes.
fn small() -> World {
    World { height: |x, y, _| if (x, y) == (77, 99) { 500 } else { 0 }, ..World::new(8) }
}

#[test]
fn every_flipped_byte_is_found() {
    let folder = Folder::new();
    let (_, bytes) = small().good(&folder);
    assert!(bytes.len() < 20_000, "{}", bytes.len());
    for at in 0..bytes.len() {
        let mut bad = bytes.clone();
        bad[at] ^= 1 << (at % 8);
        let report = report_on(&folder, &bad, Level::Checksum);
        assert!(!report.good && !report.findings.is_empty(), "byte {at}");
    }
}

#[test]
fn every_cut_is_found() {
    let folder = Folder::new();
    let (_, bytes) = small().good(&folder);
    for length in (0..bytes.len()).filter(|n| n % 17 == 0 || *n < 400 || *n + 200 > bytes.len()) {
        let report = report_on(&folder, &bytes[..length], Level::Structure);
        assert!(!report.good, "cut to {length}");
    }
    let longer = [&bytes[..], &[0; 100]].concat();
    assert_only(&report_on(&folder, &longer, Level::Checksum), &[Check::Length]);
}

#[test]
fn what_is_no_relief_file_could_not_be_run_on() {
    let folder = Folder::new();
    let refused = |path: &std::path::Path| validate(path, &Options::default()).unwrap_err();
    assert!(matches!(refused(&folder.path("none.relief")), ToolError::File { error: FormatError::Io { .. }, .. }));
    assert!(matches!(refused(&folder.path("")), ToolError::File { error: FormatError::Io { .. }, .. }));
    for text in ["II*\0 a TIFF, or something else of some length", ""] {
        let path = folder.path("other.tif");
        std::fs::write(&path, text).unwrap();
        assert!(matches!(refused(&path), ToolError::File { error: FormatError::NotRelief(_), .. }), "{text:?}");
    }
    // A newer version is not damage either, if its checksum says that it is meant.
    let (path, mut bytes) = small().good(&folder);
    bytes[8] = 9;
    let hash = *blake3::hash(&bytes[..224]).as_bytes();
    bytes[224..256].copy_from_slice(&hash);
    std::fs::write(&path, &bytes).unwrap();
    assert!(matches!(refused(&path), ToolError::File { error: FormatError::Unsupported(_), .. }));
}

#[test]
fn damage_to_the_frame_has_its_own_code() {
    let folder = Folder::new();
    let (path, bytes) = small().good(&folder);
    assert_only(&report(&path, Level::Semantic), &[]);
    let flipped = |at: usize| {
        let mut bad = bytes.clone();
        bad[at] ^= 4;
        bad
    };
    let parts = Parts::of(&bytes);
    let start = |kind| parts.sections.iter().find(|s| s.kind == kind).unwrap().offset as usize;
    let padding = start(MESH) - 1;
    assert_eq!(bytes[padding], 0);
    for (bad, check) in [
        (flipped(3), Check::Signature),
        (flipped(40), Check::Header),
        (flipped(bytes.len() - 3), Check::Tail),
        (flipped(300), Check::SectionTable),
        (flipped(padding), Check::Padding),
    ] {
        let report = report_on(&folder, &bad, Level::Checksum);
        assert_only(&report, &[check]);
        assert!(report.findings[0].place.byte.is_some());
    }
    for kind in [META, MESH, INDEX, TILES] {
        let report = report_on(&folder, &flipped(start(kind) + 9), Level::Checksum);
        assert!(report.has(Check::SectionHash), "{}", report.text());
    }
}

#[test]
fn sections_must_be_there_once_and_in_canonical_rows() {
    let folder = Folder::new();
    let (_, bytes) = small().good(&folder);
    let parts = || Parts::of(&bytes);
    let structure = |bytes: &[u8]| report_on(&folder, bytes, Level::Structure);
    assert_only(&structure(&parts().seal()), &[]);
    let bad = parts().seal_with(|sections| sections[1].kind = *b"WHAT", |_| ());
    assert_only(&structure(&bad), &[Check::Sections]);
    let mut twice = parts();
    twice.sections.push(twice.sections[0]);
    twice.bodies.push(twice.bodies[0].clone());
    assert_only(&structure(&twice.seal()), &[Check::Sections]);
    let bad = parts().seal_with(|_| (), |rows| rows[24] = 1);
    assert_only(&structure(&bad), &[Check::SectionTable]);
    let bad = parts().seal_with(|sections| sections[2].offset -= 64, |_| ());
    assert_only(&structure(&bad), &[Check::SectionTable]);
}

#[test]
fn metadata_must_be_canonical_and_agree_with_the_header() {
    let folder = Folder::new();
    let (_, bytes) = small().good(&folder);
    let changed = |from: &str, to: &str| {
        let mut parts = Parts::of(&bytes);
        let text = String::from_utf8(parts.body(META).clone()).unwrap();
        assert!(text.contains(from), "{text}");
        *parts.body(META) = text.replacen(from, to, 1).into_bytes();
        report_on(&folder, &parts.seal(), Level::Structure)
    };
    let later_key = changed("\"as given\"}", "\"as given\",\"zebra\":1}");
    assert_only(&later_key, &[]);
    for (from, to) in [
        ("\"vertical\"", "\"zebra\":1,\"vertical\""),
        (":[]", ": []"),
        ("0.125", "0.25"),
        ("6378137", "6378138"),
        ("\"fill\"", "\"full\""),
        ("{", "["),
        ("}\n", "}"),
    ] {
        assert_only(&changed(from, to), &[Check::Metadata]);
    }
}

/// One change to the index, with all checksums right.
fn with_index(bytes: &[u8], change: impl Fn(&mut Vec<Entry>), odd: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut parts = Parts::of(bytes);
    let grid = Grid::new(parts.header.m, false);
    let tile_bytes = parts.body(TILES).len() as u64;
    let index = parts.body(INDEX);
    let mut entries: Vec<Entry> =
        index.chunks_exact(ENTRY_BYTES).map(|row| Entry::decode(row, &grid, tile_bytes).unwrap()).collect();
    change(&mut entries);
    *index = entries.iter().flat_map(Entry::encode).collect();
    odd(index);
    parts.header.tile_count = entries.len() as u64;
    parts.seal()
}

#[test]
fn every_rule_of_the_index() {
    let folder = Folder::new();
    let (_, bytes) = World::new(9).good(&folder);
    let run =
        |change: &dyn Fn(&mut Vec<Entry>)| report_on(&folder, &with_index(&bytes, change, |_| ()), Level::Structure);
    assert_only(&run(&|_| ()), &[]);
    assert_only(&run(&|entries| entries[3].key = TileKey::new(0, 9, 0)), &[Check::IndexEntry, Check::TileBytes]);
    assert_only(&run(&|entries| entries[9].offset = 1 << 40), &[Check::IndexEntry, Check::TileBytes]);
    assert_only(&run(&|entries| entries[4].min_q = entries[4].max_q + 1), &[Check::IndexEntry]);
    let odd = with_index(&bytes, |_| (), |index| index[45] = 1);
    assert_only(&report_on(&folder, &odd, Level::Structure), &[Check::IndexEntry, Check::TileBytes]);
    assert_only(&run(&|entries| entries[5].key = entries[4].key), &[Check::IndexOrder]);
    assert_only(&run(&|entries| entries.swap(6, 7)), &[Check::IndexOrder, Check::TileBytes]);
    assert_only(&run(&|entries| entries[8].offset += 1), &[Check::TileBytes]);
    assert_only(&run(&|entries| entries[2].max_q = 50_000), &[Check::IndexRange]);
    let bumpy = TileKey::new(0, 0, 0);
    let with_mip = |entries: &mut Vec<Entry>| {
        let entry = entries.iter_mut().find(|entry| entry.key == bumpy).unwrap();
        entry.lengths[Plane::Mip as usize] += 1;
        entry.lengths[Plane::Nodes as usize] -= 1;
    };
    assert_only(&run(&with_mip), &[Check::PlaneLengths]);
    let short_root = |entries: &mut Vec<Entry>| {
        let lengths = &mut entries[0].lengths;
        lengths[Plane::Mip as usize] += lengths[Plane::Nodes as usize] - 15;
        lengths[Plane::Nodes as usize] = 15;
    };
    assert_only(&run(&short_root), &[Check::PlaneLengths]);
}

#[test]
fn the_tree_of_tiles_is_whole() {
    let folder = Folder::new();
    let without = |m: u32, gone: &dyn Fn(TileKey) -> bool| {
        let world = World { height: small().height, ..World::new(m) };
        let mut tiles = world.tiles();
        tiles.retain(|&key, _| !gone(key));
        let path = folder.path("x.relief");
        world.write(&path, &tiles);
        report(&path, Level::Structure)
    };
    assert_only(&without(9, &|key| key == TileKey::new(0, 2, 1)), &[]);
    let orphans = without(10, &|key| key == TileKey::new(1, 2, 0));
    assert_only(&orphans, &[Check::Ancestors, Check::TileNeighbours]);
    assert_eq!(orphans.counts[Check::Ancestors.code()], 4);
    let lonely =
        without(10, &|key| key == TileKey::new(1, 2, 0) || (key.level == 0 && key.parent() == TileKey::new(1, 2, 0)));
    assert_only(&lonely, &[Check::TileNeighbours]);
    // A column of two on the west and on the east, a row of two on the north and the corners.
    assert_eq!(lonely.counts[Check::TileNeighbours.code()], 8);
    let west = |key: TileKey| key.x >> (1 - key.level) == 0;
    assert_only(&without(9, &west), &[Check::RootTiles]);
}

#[test]
fn a_false_identity_is_found() {
    let folder = Folder::new();
    let (_, bytes) = small().good(&folder);
    let mut parts = Parts::of(&bytes);
    parts.header.content_id[5] ^= 1;
    assert_only(&report_on(&folder, &parts.seal(), Level::Checksum), &[Check::ContentId]);
}

#[test]
fn what_no_reader_opens_is_found() {
    let folder = Folder::new();
    let (_, bytes) = small().good(&folder);
    let mut parts = Parts::of(&bytes);
    parts.header.tile_count += 1;
    assert_only(&report_on(&folder, &parts.seal(), Level::Semantic), &[Check::Openable]);
}
