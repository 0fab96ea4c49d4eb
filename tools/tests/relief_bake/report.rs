//! `relief-bake report` as a user runs it.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::common::Folder;
use crate::common::rasters::Raster;

const NX: usize = 360;
const NY: usize = 180;

/// Smooth heights in metres all over the globe, even across the poles, where they are given.
fn smooth_m(lon_deg: f64, lat_deg: f64) -> f64 {
    let (lon, lat) = (lon_deg.to_radians(), lat_deg.to_radians());
    1000.0 * lat.sin() + 500.0 * lat.cos() * lon.sin()
}

/// A raster of 1 degree pixels.
fn globe(folder: &Folder) -> PathBuf {
    let path = folder.path("globe.tif");
    Raster::world(NX).write(&path, |x, y| smooth_m(x as f64 - 179.5, 89.5 - y as f64) as f32);
    path
}

/// A table's rows by column name.
fn table(path: &Path) -> Vec<HashMap<String, String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), names.len(), "{line}");
            names.iter().zip(cells).map(|(name, cell)| ((*name).to_owned(), cell.to_owned())).collect()
        })
        .collect()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

/// Why tags do not balance; none where they do.
fn unbalanced(text: &str) -> Option<String> {
    let mut open: Vec<&str> = Vec::new();
    for part in text.split('<').skip(1) {
        let Some((tag, rest)) = part.split_once('>') else { return Some(format!("<{part} has no end")) };
        if rest.contains('>') {
            return Some(format!("a bare > after <{tag}>"));
        }
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap();
        if tag.starts_with('/') {
            if open.pop() != Some(name) {
                return Some(format!("</{name}> closes nothing"));
            }
        } else if !tag.starts_with(['!', '?']) && !tag.ends_with('/') && !["meta", "br"].contains(&name) {
            open.push(name);
        }
    }
    open.pop().map(|name| format!("<{name}> stays open"))
}

#[test]
fn the_balance_of_tags_is_checked() {
    assert_eq!(unbalanced("<!DOCTYPE html><p>a<br>b<rect x=\"1\"/></p>"), None);
    assert!(unbalanced("<p><b>a</p></b>").is_some());
    assert!(unbalanced("<p>").is_some());
    assert!(unbalanced("<p>1 > 0</p>").is_some());
    assert!(unbalanced("</p>").is_some());
}

#[test]
fn a_report_holds_together() {
    let folder = Folder::new();
    let (source, out) = (globe(&folder), folder.path("report"));
    let run = relief_bake!("report", source, "-o", out, "--vertical", "as-given", "--threads", "2", "--quiet");
    assert_eq!((run.code, run.stdout.as_str(), run.stderr.as_str()), (0, "", ""));
    let mut names: Vec<String> =
        std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let svgs = ["bytes-against-error.svg", "codecs.svg", "kernels.svg", "planes.svg", "speed.svg"];
    assert_eq!(
        names,
        [&svgs[..1], &["codecs.csv"], &svgs[1..2], &["index.html"], &svgs[2..4], &["report.csv"], &svgs[4..]].concat()
    );

    let rows = table(&out.join("report.csv"));
    let steps: Vec<_> = rows.iter().filter(|row| row["varied"] == "step").collect();
    assert_eq!(steps.len(), 10);
    for (n, row) in steps.iter().enumerate() {
        let step_m = number(row, "step_m");
        assert_eq!(step_m, f64::from(n as i32 - 6).exp2());
        let (largest_m, rms_m) = (number(row, "node_max_error_m"), number(row, "node_rms_error_m"));
        assert!(largest_m <= step_m / 2.0 && largest_m > 0.4 * step_m, "{row:?}");
        assert!(rms_m > 0.2 * step_m && rms_m < 0.35 * step_m, "{row:?}");
        // Nothing else than rounding and the curvature of the heights: no shift, no flip.
        assert!(number(row, "sample_max_error_m") < step_m / 2.0 + 0.1, "{row:?}");
        assert_eq!(number(row, "samples_compared"), (NX * NY) as f64);
        assert_eq!(number(row, "nodes_compared"), number(row, "nodes"));
        assert!(number(row, "encode_s") > 0.0 && number(row, "decode_s") > 0.0);
        let parts = ["nodes", "mip", "hext", "deviation", "filled", "other"];
        let parts: f64 = parts.iter().map(|part| number(row, &format!("{part}_bytes"))).sum();
        assert_eq!(parts, number(row, "file_bytes"));
    }

    let kernels: Vec<_> = rows.iter().filter(|row| row["varied"] == "kernel").collect();
    let error_m = |name: &str| number(kernels.iter().find(|row| row["kernel"] == name).unwrap(), "sample_rms_error_m");
    assert_eq!(kernels.len(), 5);
    assert!(error_m("cubic") < error_m("nearest") && error_m("bilinear") < error_m("nearest"));
    assert!(error_m("lanczos") < error_m("nearest") && error_m("average") < error_m("nearest"));
    assert_eq!(error_m("cubic"), number(steps[2], "sample_rms_error_m"));

    let codecs = std::fs::read_to_string(out.join("codecs.csv")).unwrap();
    assert_eq!(codecs.lines().count(), 7);
    let whole = format!(",{},", steps[2]["file_bytes"]);
    assert!(codecs.lines().any(|line| line.starts_with("\"relief, everything\"") && line.contains(&whole)), "{codecs}");

    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert_eq!(unbalanced(&page), None);
    assert_eq!(page.matches("<svg ").count(), svgs.len());
    assert!(page.contains("globe.tif") && page.contains(env!("CARGO_PKG_VERSION")));
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("http") && !page.contains("<script"));
    for name in svgs {
        let svg = std::fs::read_to_string(out.join(name)).unwrap();
        assert_eq!(unbalanced(&svg), None, "{name}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
    }

    // A second report wants a word before it replaces the first.
    relief_bake!("report", source, "-o", out, "--vertical", "as-given").refused(&["--force"]);
    let again = relief_bake!("report", source, "-o", out, "--vertical", "as-given", "--force");
    assert_eq!((again.code, again.stdout.trim_end()), (0, out.join("index.html").to_str().unwrap()));
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), names.len());
    let columns = |row: &HashMap<String, String>| {
        let same = row.iter().filter(|(name, _)| !name.starts_with("encode") && !name.starts_with("decode"));
        same.map(|(name, cell)| (name.clone(), cell.clone())).collect::<HashMap<_, _>>()
    };
    let second: Vec<_> = table(&out.join("report.csv")).iter().map(columns).collect();
    assert_eq!(second, rows.iter().map(columns).collect::<Vec<_>>());
}

#[test]
fn a_plane_has_no_kernels_and_integers_lose_nothing() {
    let folder = Folder::new();
    let out = folder.path("report");
    std::fs::create_dir(&out).unwrap();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/fiji_across_180.tif");
    let run = relief_bake!("report", source, "-o", out, "--body", "plane", "--vertical", "as-given", "--quiet");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let rows = table(&out.join("report.csv"));
    assert_eq!(rows.len(), 10);
    for row in &rows {
        let (largest_m, step_m) = (number(row, "sample_max_error_m"), number(row, "step_m"));
        // But for the rounding of a place that is computed from coordinates.
        let expected_m = if step_m <= 1.0 { 0.0 } else { step_m / 2.0 };
        assert!((largest_m - expected_m).abs() < 1e-6, "{row:?}");
        assert_eq!(number(row, "node_max_error_m"), expected_m);
        assert_eq!(number(row, "samples_compared"), 216.0 * 168.0);
    }
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("nothing is resampled") && page.contains("loses nothing"));
    assert_eq!(unbalanced(&page), None);
    assert!(!out.join("kernels.svg").exists());
}

#[test]
fn coarser_steps_of_real_terrain_take_fewer_bytes() {
    let folder = Folder::new();
    let out = folder.path("report");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/moon_dem_halfmetre_dn.tif");
    let run = relief_bake!("report", source, "-o", out, "--m", "8", "--memory", "64MiB");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let rows = table(&out.join("report.csv"));
    let steps = rows.iter().filter(|row| row["varied"] == "step");
    let bytes: Vec<f64> = steps.map(|row| number(row, "file_bytes")).collect();
    assert!(bytes.windows(2).all(|pair| pair[1] < pair[0]), "{bytes:?}");
    // The source's own step is half a metre; 64 MiB hold 16 MiB of samples, which are not all.
    assert!(rows.iter().filter(|row| row["varied"] == "kernel").all(|row| row["step_m"] == "0.5"));
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("A bake would choose m = 9") && page.contains("every 2nd row"), "{page}");
}

#[test]
fn what_cannot_be_reported_leaves_nothing() {
    let folder = Folder::new();
    let (source, out) = (globe(&folder), folder.path("report"));
    let before = folder.names();
    relief_bake!("report", folder.path("none.tif"), "-o", out).refused(&["none.tif"]);
    relief_bake!("report", source, "-o", out).refused(&["--vertical"]);
    relief_bake!("report", source, "-o", out, "--vertical", "as-given", "--m", "30").refused(&["m = 30", "8 to 20"]);
    relief_bake!("report", source, "-o", folder.path("no/where"), "--vertical", "as-given").refused(&["no/where"]);
    relief_bake!("report", source, "-o", source, "--vertical", "as-given").refused(&["it is a file"]);
    relief_bake!("report", source, "-o", out, "--vertical", "as-given", "--threads", "0").refused(&["--threads 0"]);
    assert_eq!(relief_bake!("report", source).code, 2);
    assert_eq!(relief_bake!("report", "-o", out).code, 2);
    assert_eq!(relief_bake!("report", source, "-o", out, "--vertical", "msl").code, 2);
    assert_eq!(folder.names(), before);
}
