//! `relief-bake probe` as a user runs it.

use std::ffi::OsStr;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

use crate::common::{Folder, Value, earth, plane, program, wavy_q};
use relief_formats::grid::Grid;

fn lines(file: &Path, more: &[&str], stdin: &str) -> (i32, Vec<Value>) {
    let mut arguments = vec![OsStr::new("probe"), file.as_os_str(), OsStr::new("-")];
    arguments.extend(more.iter().map(OsStr::new));
    let run = crate::common::run(&arguments, Some(stdin));
    assert!(run.stderr.is_empty(), "{}", run.stderr);
    (run.code, run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect())
}

#[test]
fn a_node_gives_its_height_and_its_place() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(9));
    let grid = Grid::new(9, false);
    let height_m = f64::from(wavy_q(grid, 300, 200)) / 16.0;
    let (lon, lat) = (grid.lon_deg(0, 300).to_string(), grid.lat_deg(0, 200).to_string());
    let answer = relief_bake!("probe", file, lon, lat, "--json").json(0);
    assert_eq!(answer["height_m"], height_m);
    assert_eq!((&answer["level"], &answer["filled"]), (&0.into(), &false.into()));
    let bound = |k: usize| answer["bounds_m"][k].as_f64().unwrap();
    assert!(bound(0) <= height_m && height_m <= bound(1));
    let ecef: Vec<f64> = answer["ecef_m"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    let radius = ecef.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((6.35e6..6.38e6).contains(&radius), "{radius}");
    assert!((ecef[1].atan2(ecef[0]).to_degrees() - grid.lon_deg(0, 300)).abs() < 1e-9);
    let text = relief_bake!("probe", file, lon, lat).stdout;
    assert!(text.contains(&format!("{height_m} m")), "{text}");
    let pole = relief_bake!("probe", file, "-33.3", "-90", "--level", "1", "--json").json(0);
    assert_eq!((&pole["height_m"], &pole["level"]), (&(-177.1875).into(), &1.into()));
    assert_eq!((&pole["ecef_m"][0], &pole["ecef_m"][1]), (&0.0.into(), &0.0.into()));
}

#[test]
fn lines_are_answered_in_order() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(9));
    let grid = Grid::new(9, false);
    let nodes: Vec<(u32, u32)> = (0..20_000u32).map(|k| (k * 7919 % 1024, k * 104_729 % 513)).collect();
    let text: String =
        nodes.iter().map(|&(i, j)| format!("{} {}\n", grid.lon_deg(0, i.into()), grid.lat_deg(0, j.into()))).collect();
    let (code, answers) = lines(&file, &[], &text);
    assert_eq!((code, answers.len()), (0, nodes.len()));
    for (answer, &(i, j)) in answers.iter().zip(&nodes) {
        assert_eq!(answer["height_m"], f64::from(wavy_q(grid, i, j)) / 16.0, "node ({i}, {j})");
    }
}

#[test]
fn a_bad_line_is_named_and_the_others_are_answered() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(8));
    let (code, answers) = lines(&file, &[], "0 0\nhere\n10 91\n\n720,-45.5\r\nnan 0\n1 2 3\n5 5");
    assert_eq!((code, answers.len()), (1, 8));
    for (k, answer) in answers.iter().enumerate() {
        assert_eq!(answer.get("error").is_some(), [1, 2, 3, 5, 6].contains(&k), "{answer}");
        assert_eq!(answer.get("height_m").is_some(), [0, 4, 7].contains(&k), "{answer}");
    }
    assert_eq!(answers[2]["line"], 3);
    assert!(answers[2]["error"].as_str().unwrap().contains("91"));
    assert_eq!(lines(&file, &[], ""), (0, vec![]));
}

#[test]
fn a_plane_is_asked_in_its_crs() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &plane(8));
    let answer = relief_bake!("probe", file, "500300", "4000200", "--json").json(0);
    assert_eq!(answer["height_m"], f64::from(wavy_q(Grid::new(8, true), 10, 10)) / 16.0);
    assert!(answer.get("ecef_m").is_none());
    relief_bake!("probe", file, "0", "0").refused(&["X 0", "500000", "rule:"]);
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(8));
    relief_bake!("probe", file, "0", "90.5").refused(&["90.5", "-90 to 90"]);
    relief_bake!("probe", file, "east", "0").refused(&["east"]);
    relief_bake!("probe", file, "NaN", "0").refused(&["NaN"]);
    relief_bake!("probe", file, "7").refused(&["7 alone"]);
    relief_bake!("probe", file, "-", "7").refused(&["standard input"]);
    relief_bake!("probe", file, "0", "0", "--level", "1").refused(&["--level 1", "0 (finest) to 0"]);
    relief_bake!("probe", folder.path("none.relief"), "0", "0").refused(&["none.relief"]);
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let folder = Folder::new();
    let file = folder.sample("a.relief", &earth(8));
    let mut child = program()
        .args([OsStr::new("probe"), file.as_os_str(), OsStr::new("-")])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    // The program may leave before it has read all.
    let _ = child.stdin.take().unwrap().write_all("1 2\n".repeat(200_000).as_bytes());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr), (Some(0), vec![]));
}
