//! Decoded samples: digests, seams, poles, derived planes, the mesh.

use relief_tools::validate::{Check, Level};

use crate::build::{Folder, World};
use crate::{assert_only, report};

#[test]
fn right_files_have_no_findings() {
    let folder = Folder::new();
    let one_corner = World::sparse(9, &[(0, 0), (3, 1)]);
    for (name, world) in [("m8", World::new(8)), ("m9", World::new(9)), ("plane", World::plane(9)), ("sparse", one_corner)] {
        let path = folder.path(name);
        world.write(&path, &world.tiles());
        let report = report(&path, Level::Semantic);
        println!("{name}: {}", report.text());
        assert_only(&report, &[]);
        assert!(report.good && report.level_reached == Level::Semantic);
    }
    let _ = Check::ALL;
}
