//! The command itself: exit codes, JSON, JUnit.

use std::ffi::OsStr;
use std::path::Path;

use relief_formats::tile::TileKey;
use relief_tools::validate::Check;

use super::world::World;
use crate::common::{Folder, Run};

fn run(arguments: &[&str]) -> Run {
    let arguments: Vec<&OsStr> = ["validate"].iter().chain(arguments).map(OsStr::new).collect();
    crate::common::run(&arguments, None)
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn exit_codes_and_what_is_printed() {
    let folder = Folder::new();
    let world = World::new(8);
    let (good, _) = world.good(&folder);
    let output = run(&[text(&good)]);
    assert_eq!(output.code, 0, "{output:?}");
    assert!(output.stdout.ends_with("good (semantic)\n"));

    let mut tiles = world.tiles();
    tiles.get_mut(&TileKey::new(0, 0, 0)).unwrap().nodes[33 * 257 + 256] += 3;
    let torn = folder.path("torn.relief");
    world.write(&torn, &tiles);
    let output = run(&[text(&torn), "--quiet"]);
    assert_eq!(output.code, 1, "{output:?}");
    assert!(output.stdout.starts_with("RLF-N001 error: "), "{output:?}");

    for arguments in [
        &[text(&folder.path("none.relief"))][..],
        &[text(&good), "--level", "source"],
        &[text(&good), "--level", "structure", "--against", "x.tif"],
        &[text(&good), "--against", text(&folder.path("none.tif"))],
        &[text(&good), "--memory", "much"],
    ] {
        let output = run(arguments);
        assert_eq!(output.code, 2, "{output:?}");
        assert!(!output.stderr.is_empty() && output.stdout.is_empty(), "{output:?}");
    }
}

#[test]
fn json_and_junit_name_the_place() {
    let folder = Folder::new();
    let world = World::new(8);
    let mut tiles = world.tiles();
    tiles.get_mut(&TileKey::new(0, 0, 0)).unwrap().nodes[33 * 257 + 256] += 3;
    let (torn, xml) = (folder.path("torn.relief"), folder.path("out.xml"));
    world.write(&torn, &tiles);
    let output = run(&[text(&torn), "--json", "--junit", text(&xml), "--quiet"]);
    let json: serde_json::Value = serde_json::from_str(&output.stdout).unwrap();
    assert_eq!((json["good"].as_bool(), json["level"].as_str()), (Some(false), Some("semantic")));
    assert_eq!(json["content_id"].as_str().unwrap().len(), 64);
    assert_eq!(json["counts"]["RLF-N001"], 1);
    let finding = &json["findings"][0];
    assert_eq!((finding["code"].as_str(), finding["severity"].as_str()), (Some("RLF-N001"), Some("error")));
    let place = &finding["where"];
    assert_eq!(
        (place["level"].as_u64(), place["tile"][0].as_u64(), place["lon_deg"].as_f64()),
        (Some(0), Some(0), Some(0.0))
    );
    let xml = std::fs::read_to_string(xml).unwrap();
    let cases = Check::ALL.iter().filter(|check| !check.code().starts_with("RLF-X")).count();
    assert_eq!(xml.matches("<testcase ").count(), cases);
    assert!(xml.contains("<failure message=\"1 findings against: neighbouring tiles"), "{xml}");
}

#[test]
fn help_lists_every_code() {
    let help = run(&["--help"]).stdout;
    for check in Check::ALL {
        assert!(help.contains(check.code()), "{}", check.code());
    }
}
