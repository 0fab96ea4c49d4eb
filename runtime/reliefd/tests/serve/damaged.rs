//! A tile that is damaged on the disk.

use relief_formats::file::{Plane, Relief};
use relief_formats::tile::TileKey;
use relief_protocol::error::Code;
use relief_tests::folder::Folder;

use crate::daemon::Daemon;
use crate::viewer::{Viewer, down};

#[test]
fn a_damaged_tile_is_told_of_and_a_coarser_one_stands_in() {
    let folder = Folder::new();
    let (path, other) = (folder.globe("a.relief", 10), folder.globe("b.relief", 8));
    let mut bytes = std::fs::read(&path).unwrap();
    let relief = Relief::from_bytes(&bytes).unwrap();
    // The tile at longitude 0 to 45, latitude 0 to 45.
    let entry = relief.find(TileKey::new(0, 4, 2)).unwrap().unwrap();
    let plane = relief.plane_bytes(&entry, Plane::Nodes);
    let (at, length) = (plane.as_ptr().addr() - relief.bytes().as_ptr().addr(), plane.len());
    bytes[at + length / 2..][..16].fill(0x5a);
    std::fs::write(&path, bytes).unwrap();
    let daemon = Daemon::serve(&[&path, &other]);
    let (mut low, mut witness) = (Viewer::of(&daemon, "a"), Viewer::of(&daemon, "b"));
    let (header, _) = low.look(down(20.0, 20.0, 1e5));
    assert_eq!(header.stats.tiles_missing, 0, "what can never come is not missing");
    let fault = low.fault(Code::Damaged);
    assert!(fault.what.contains("a: 1 damaged tile"), "{fault}");
    assert!(!fault.fatal && !fault.remedy.is_empty());
    // Everything else goes on.
    low.look(down(-60.0, -20.0, 1e5));
    witness.look(down(20.0, 20.0, 1e5));
    daemon.says("damaged tile", 1);
}
