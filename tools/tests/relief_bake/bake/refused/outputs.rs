//! Outputs that cannot be written, or not whole.

use std::path::PathBuf;
use std::process::Command;

use super::refused_as;
use crate::common::{Folder, Run, data};

#[test]
fn outputs_that_cannot_be() {
    let folder = Folder::new();
    let moon = data("moon_dem_halfmetre_dn.tif");
    refused_as(&folder, &folder.path("none/out.relief"), &moon, &[], &["none/out.relief", "missing", "mkdir"]);
    std::fs::write(folder.path("file"), "a file in a folder's place").unwrap();
    refused_as(&folder, &folder.path("file/out.relief"), &moon, &[], &["file/out.relief"]);
    std::fs::create_dir(folder.path("folder")).unwrap();
    refused_as(&folder, &folder.path("folder"), &moon, &["--force"], &["folder", "the output is a file"]);
    let there = folder.path("there.relief");
    std::fs::write(&there, "the user's own").unwrap();
    refused_as(&folder, &there, &moon, &[], &["there.relief", "exists", "--force"]);
    assert_eq!(std::fs::read(&there).unwrap(), b"the user's own");
}

/// With --force a file is replaced by a good bake, and kept by one that fails.
#[test]
fn force_replaces_only_by_what_is_whole() {
    let folder = Folder::new();
    let there = folder.path("there.relief");
    std::fs::write(&there, "the user's own").unwrap();
    let earth = data("earth_etopo1_6min.tif");
    let options = ["--force", "--vertical", "ellipsoid", "--m", "8", "--step", "0.0009765625"];
    refused_as(&folder, &there, earth, &options, &["steps of 0.0009765625", "2^23", "--step"]);
    let moon = data("moon_dem_halfmetre_dn.tif");
    let run = relief_bake!("bake", moon, "-o", there, "--force", "--m", "8", "--quiet");
    assert_eq!((run.code, folder.names()), (0, vec!["there.relief".to_string()]), "{}", run.stderr);
    assert_eq!(relief_bake!("validate", there).code, 0);
}

#[test]
fn a_folder_that_is_read_only() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    let locked = folder.path("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    let output = locked.join("out.relief");
    let moon = data("moon_dem_halfmetre_dn.tif");
    // Root writes where it may not: then a folder of the kernel's, read-only for all, stands in.
    let open_to_root = std::fs::write(locked.join("probe"), "").is_ok();
    let output = if open_to_root { PathBuf::from("/proc/out.relief") } else { output };
    refused_as(&folder, &output, moon, &["--m", "8"], &["out.relief"]);
}

/// A disk that is full from the start (the work file is the device that always is), and one that
/// fills up on the way (a limit on the size of files).
#[test]
fn disks_that_are_full() {
    let folder = Folder::new();
    let moon = data("moon_dem_halfmetre_dn.tif");
    std::os::unix::fs::symlink("/dev/full", folder.path("out.relief.part")).unwrap();
    let run = relief_bake!("bake", moon, "-o", folder.path("out.relief"), "--quiet");
    run.refused(&["out.relief", "No space left", "rule:", "free some space"]);
    assert!(folder.names().is_empty(), "{:?}", folder.names());

    let limited = |kib: u32| {
        let script = format!("trap '' XFSZ; ulimit -f {kib}; exec \"$@\"");
        let mut command = Command::new("bash");
        command.args(["-c", &script, "bash", env!("CARGO_BIN_EXE_relief-bake"), "bake", "--quiet", "-o"]);
        Run::of(command.arg(folder.path("out.relief")).arg(&moon), "")
    };
    for kib in [0, 1, 100, 500] {
        limited(kib).refused(&["out.relief", "rule:", "free some space"]);
        assert!(folder.names().is_empty(), "{kib} KiB: {:?}", folder.names());
    }
    limited(100_000).good();
    assert_eq!(folder.names(), ["out.relief"]);
}
