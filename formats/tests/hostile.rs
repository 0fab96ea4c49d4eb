//! Hostile files: whatever the bytes, an error or the same samples; no panic, and no memory by a
//! number that the file has not earned.

#[path = "hostile/counting.rs"]
mod counting;
#[path = "../fuzz/src/lib.rs"]
mod harness;
#[path = "hostile/small.rs"]
mod small;

use counting::measure;
use harness::read_all;
use relief_formats::file::index::Digest;
use relief_formats::file::section::{INDEX, TILES};
use relief_formats::file::{FormatError, Plane, Relief};
use relief_formats::tiles::Tiles;
use small::{file_with_mesh, small_file};

/// Decoded tiles that a reader keeps at most in these tests, the planes it is working on and the
/// mesh: a constant beside the file's size.
const WORKING_BYTES: usize = 24 << 20;
/// The largest single piece of that: a mesh's content.
const PIECE_BYTES: usize = 1 << 20;

fn read(bytes: &[u8]) -> Result<Vec<Digest>, FormatError> {
    let relief = Relief::from_bytes(bytes)?;
    read_all(&relief, &Tiles::new(&relief, 0), usize::MAX)
}

/// Reads, and checks what that took.
fn read_frugally(bytes: &[u8]) -> Result<Vec<Digest>, FormatError> {
    let (out, peak, largest) = measure(|| read(bytes));
    assert!(peak <= 8 * bytes.len() + WORKING_BYTES, "{peak} bytes for a file of {}", bytes.len());
    assert!(largest <= 8 * bytes.len() + PIECE_BYTES, "{largest} bytes at once for a file of {}", bytes.len());
    out
}

fn section(bytes: &[u8], kind: [u8; 4]) -> std::ops::Range<usize> {
    let relief = Relief::from_bytes(bytes).expect("a good file");
    let section = *relief.sections().iter().find(|s| s.kind == kind).expect("a section");
    section.offset as usize..(section.offset + section.length) as usize
}

#[test]
fn the_small_files_have_something_in_every_plane() {
    for plane in [true, false] {
        let bytes = small_file(plane);
        assert!(read_frugally(&bytes).is_ok());
        let relief = Relief::from_bytes(&bytes).expect("a good file");
        for entry in relief.entries().map(|entry| entry.expect("an entry")) {
            for plane in Plane::ALL {
                let needless = plane == Plane::Mip && entry.key.level == 0;
                assert_eq!(relief.plane_bytes(&entry, plane).is_empty(), needless, "{plane:?} of {:?}", entry.key);
            }
        }
    }
}

/// A plane of m = 8: all its bytes.
#[test]
fn every_flipped_byte_is_an_error_or_changes_nothing() {
    let good = small_file(true);
    let expected = read(&good).expect("a good file");
    let mut unseen = 0;
    for (at, bit) in (0..good.len()).flat_map(|at| [(at, at % 8), (at, (at * 5 + 3) % 8)]) {
        let mut bad = good.clone();
        bad[at] ^= 1 << bit;
        match read_frugally(&bad) {
            Ok(samples) => {
                assert_eq!(samples, expected, "byte {at} changes samples unseen");
                unseen += 1;
            }
            Err(FormatError::Request(text)) => panic!("byte {at} blames the caller: {text}"),
            Err(_) => {}
        }
    }
    // Only zeros between sections may pass; a checker of whole files looks at those.
    assert!(unseen < 2 * 5 * 64, "{unseen} of {} flips go unseen", good.len());
}

/// A sparse globe: no flip in the index makes a present tile look absent.
#[test]
fn a_damaged_index_is_noticed() {
    let good = small_file(false);
    let index = section(&good, INDEX);
    for at in index {
        let mut bad = good.clone();
        bad[at] ^= 1 << (at * 3 % 8);
        assert!(read_frugally(&bad).is_err(), "byte {at}");
    }
}

#[test]
fn every_cut_is_an_error() {
    for plane in [true, false] {
        let good = small_file(plane);
        for length in 0..good.len() {
            assert!(Relief::from_bytes(&good[..length]).is_err(), "cut at {length}");
        }
        let longer = [good.as_slice(), &[0; 64]].concat();
        assert!(Relief::from_bytes(&longer).is_err());
    }
}

#[test]
fn newer_minor_versions_are_read() {
    let good = small_file(true);
    let mut newer = good.clone();
    // The minor version, an optional feature, a reserved field of the header and one of a section.
    for at in [10, 24, 210, 256 + 24] {
        newer[at] = 1;
    }
    let newer = harness::repaired(&newer);
    assert_eq!(read(&newer).expect("still a good file"), read(&good).expect("a good file"));
    let mut required = good;
    required[16] = 1;
    assert!(matches!(read(&harness::repaired(&required)), Err(FormatError::Unsupported(_))));
}

#[test]
fn a_mesh_of_another_map_is_refused() {
    let mesh = |m| Relief::from_bytes(&file_with_mesh(true, m)).expect("a good file").patch_mesh();
    assert_eq!(mesh(8).expect("its mesh").m, 8);
    assert!(matches!(mesh(10), Err(FormatError::Damaged(text)) if text.contains("m = 10")));
}

/// What stands in the bytes of tiles may be anything once nobody checks digests.
#[test]
fn decoders_that_trust_survive_damaged_tiles() {
    let good = small_file(false);
    let tiles = section(&good, TILES);
    for (k, at) in tiles.step_by(11).enumerate() {
        let mut bad = good.clone();
        bad[at] ^= 1 << (k % 8);
        let bad = harness::repaired(&bad);
        let relief = Relief::from_bytes(&bad).expect("repaired");
        let (_, peak, largest) = measure(|| read_all(&relief, &Tiles::new(&relief, 0).trusting(), 4).is_ok());
        assert!(peak <= WORKING_BYTES && largest <= PIECE_BYTES, "byte {at}: {peak}, {largest}");
    }
}

/// Huge numbers under good checksums: the file's own size is what memory is paid with.
#[test]
fn numbers_that_are_not_earned_allocate_nothing() {
    let good = small_file(true);
    let index = section(&good, INDEX).start;
    // tile count, section count, m, plane lengths, tile offset
    for (at, size) in [(72, 8), (96, 4), (33, 1), (index + 16, 4), (index + 28, 4), (index + 8, 8), (256 + 16, 8)] {
        for value in [0x7f, 0xff] {
            let mut bad = good.clone();
            bad[at..at + size].fill(value);
            assert!(read_frugally(&harness::repaired(&bad)).is_err(), "{size} bytes of {value:#x} at {at}");
        }
    }
}

/// The same functions that cargo-fuzz drives, over a bounded number of mutations.
#[test]
fn the_fuzz_harness_holds_for_a_while() {
    let corpus = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    type Target = fn(&[u8]);
    let targets: [(&str, Target, usize); 4] = [
        ("open_and_read", harness::open_and_read, 60),
        ("plane_nodes", harness::plane_nodes, 300),
        ("mesh", harness::mesh, 2000),
        ("metadata", harness::metadata, 5000),
    ];
    for (name, target, rounds) in targets {
        let mut seeds: Vec<_> = std::fs::read_dir(corpus.join(name))
            .expect("its corpus")
            .map(|entry| entry.expect("an entry").path())
            .collect();
        seeds.sort();
        assert!(!seeds.is_empty(), "{name} has no seeds");
        let mut random = 0x9e37_79b9_7f4a_7c15u64;
        for path in &seeds {
            let seed = std::fs::read(path).expect("a seed");
            target(&seed);
            for _ in 0..rounds / seeds.len() {
                target(&mutated(&seed, &mut random));
            }
        }
    }
}

/// One to four changes: a flip, a number at its end, a cut, a piece moved.
fn mutated(seed: &[u8], random: &mut u64) -> Vec<u8> {
    let mut next = |below: usize| {
        *random ^= *random << 13;
        *random ^= *random >> 7;
        *random ^= *random << 17;
        (*random >> 20) as usize % below.max(1)
    };
    let mut out = seed.to_vec();
    for _ in 0..=next(4) {
        if out.is_empty() {
            break;
        }
        let at = next(out.len());
        match next(6) {
            0..3 => out[at] ^= 1 << next(8),
            3 => out[at] = [0, 0x7f, 0x80, 0xff][next(4)],
            4 => out.truncate(at),
            _ => {
                let from = next(out.len());
                let size = next(out.len() - at.max(from)).min(64);
                out.copy_within(from..from + size, at);
            }
        }
    }
    out
}
