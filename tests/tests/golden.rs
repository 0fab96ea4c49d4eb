//! The golden files of every released version are read for ever, sample for sample.
//!
//! FILE.txt beside each holds what its writer knew; the second reader in tests/python must find the
//! same. `cargo run --release -p relief-formats --example golden` makes the files of a new version.

use std::path::{Path, PathBuf};

use relief_formats::file::Relief;

#[path = "../../formats/examples/golden/samples.rs"]
mod samples;

const VERSIONS: [(&str, &[&str]); 1] = [("1.0", &["globe_m8", "globe_m9_sparse", "globe_m10_sparse", "plane_m8"])];

fn golden(version: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(version)
}

fn lines(path: &Path) -> Vec<String> {
    let relief = Relief::open(path).unwrap_or_else(|error| panic!("{error}"));
    samples::lines(&relief).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn first_difference(found: &[String], expected: &str) -> Option<String> {
    let expected: Vec<&str> = expected.lines().collect();
    if found.len() != expected.len() {
        return Some(format!("{} lines, expected {}", found.len(), expected.len()));
    }
    found.iter().zip(expected).find(|(f, e)| f != e).map(|(f, e)| format!("found {f}, expected {e}"))
}

#[test]
fn every_sample_of_every_version_is_still_there() {
    for (version, names) in VERSIONS {
        for name in names {
            let path = golden(version).join(name).with_extension("relief");
            let expected = std::fs::read_to_string(path.with_extension("txt")).expect("its lines");
            assert_eq!(first_difference(&lines(&path), &expected), None, "{version} {name}");
        }
    }
}

#[test]
fn a_changed_line_is_noticed() {
    let path = golden("1.0").join("plane_m8.relief");
    let found = lines(&path);
    let good = found.join("\n");
    assert_eq!(first_difference(&found, &good), None);
    for line in &found {
        let (head, last) = line.split_at(line.len() - 1);
        let other = if last == "0" { "1" } else { "0" };
        assert!(first_difference(&found, &good.replacen(line, &format!("{head}{other}"), 1)).is_some(), "{line}");
    }
    assert!(first_difference(&found[1..], &good).is_some());
}

#[test]
fn no_golden_file_is_forgotten() {
    for (version, names) in VERSIONS {
        let mut there: Vec<String> = std::fs::read_dir(golden(version))
            .expect("the folder of golden files")
            .map(|entry| entry.expect("its entry").path())
            .filter(|path| path.extension().is_some_and(|extension| extension == "relief"))
            .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
            .collect();
        there.sort();
        let mut names = names.to_vec();
        names.sort_unstable();
        assert_eq!(there, names, "{version}");
    }
}
