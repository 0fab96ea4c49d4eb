//! The command itself: exit codes, JSON, JUnit.

use std::path::Path;
use std::process::{Command, Output};

use relief_formats::tile::TileKey;
use relief_tools::validate::Check;

use super::build::{Folder, World};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_relief-bake")).arg("validate").args(arguments).output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn exit_codes_and_what_is_printed() {
    let folder = Folder::new();
    let world = World::new(8);
    let (good, _) = folder.good(&world);
    let output = run(&[text(&good)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stdout).ends_with("good (semantic)\n"));

    let mut tiles = world.tiles();
    tiles.get_mut(&TileKey::new(0, 0, 0)).unwrap().nodes[33 * 257 + 256] += 3;
    let torn = folder.path("torn.relief");
    world.write(&torn, &tiles);
    let output = run(&[text(&torn), "--quiet"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("RLF-N001 error: "), "{output:?}");

    for arguments in [
        &[text(&folder.path("none.relief"))][..],
        &[text(&good), "--level", "source"],
        &[text(&good), "--level", "structure", "--against", "x.tif"],
        &[text(&good), "--against", text(&folder.path("none.tif"))],
        &[text(&good), "--memory", "much"],
    ] {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
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
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
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
    let help = String::from_utf8(run(&["--help"]).stdout).unwrap();
    for check in Check::ALL {
        assert!(help.contains(check.code()), "{}", check.code());
    }
}
