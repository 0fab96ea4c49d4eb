//! Inspect for human readers.

use std::fmt::Write as _;

use relief_formats::body::Body;
use relief_formats::file::{Plane, Relief};
use serde_json::Value;

use super::facts::{Facts, hex};

pub fn text(relief: &Relief, facts: &Facts) -> String {
    let (header, grid, metadata) = (relief.header(), relief.grid(), relief.metadata());
    let metres = |q: i32| format!("{} m", f64::from(q) * header.step_m());
    let mut out = String::new();
    let mut row = |name: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{name:<14}{value}");
    };
    let (poles, spacing) = match &header.body {
        Body::Ellipsoid { name, a_m, b_m } => {
            row("body", format!("{name}, a = {a_m} m, b = {b_m} m"));
            let at_equator_m = std::f64::consts::TAU * a_m / f64::from(grid.width(0));
            let spacing_deg = grid.spacing_deg(0);
            (["south pole", "north pole"], format!("{spacing_deg:.7} degrees, {at_equator_m:.1} m at the equator"))
        }
        Body::Plane { crs_wkt, x0, y0, dx, dy } => {
            row("body", "plane".into());
            row("crs", crs_name(crs_wkt));
            row("first node", format!("X {x0}, Y {y0}"));
            (["first node", "last node"], format!("{dx} x {dy} CRS units"))
        }
    };
    row("grid", format!("m = {}: {} x {} nodes", header.m, grid.width(0), grid.height(0)));
    row("spacing", spacing);
    row("heights", format!("{} to {}", metres(header.min_q), metres(header.max_q)));
    row(poles[0], metres(header.south_pole_q));
    row(poles[1], metres(header.north_pole_q));
    row("step", format!("{} m, error at most {} m", header.step_m(), metadata.bound_m));
    row("vertical", metadata.vertical.clone());
    row("resampling", metadata.resampling.clone());
    row("fill", metadata.fill.clone());
    row("tiles", format!("{} in {} levels", header.tile_count, grid.root_level() + 1));
    row("file", format!("{} ({} bytes)", size(header.file_bytes), header.file_bytes));
    row("content id", hex(&header.content_id));
    tables(&mut out, relief, facts);
    for (k, source) in metadata.sources.iter().enumerate() {
        let _ = writeln!(out, "\nsource {}      {}", k + 1, describe(source));
    }
    out
}

fn tables(out: &mut String, relief: &Relief, facts: &Facts) {
    let grid = relief.grid();
    let _ = writeln!(out, "\nplane              stored           raw   ratio");
    for (plane, [bytes, raw]) in Plane::ALL.iter().zip(facts.planes) {
        let ratio = if bytes > 0 { format!("{:8.2}", raw as f64 / bytes as f64) } else { "       -".into() };
        let _ = writeln!(out, "{:<12}{:>13} {:>13}{ratio}", plane.name(), size(bytes), size(raw));
    }
    let _ = writeln!(out, "\nlevel           nodes   tiles   of all        stored");
    for (level, (&tiles, &bytes)) in (0u32..).zip(facts.tiles.iter().zip(&facts.level_bytes)) {
        let nodes = format!("{} x {}", grid.width(level), grid.height(level));
        let all = u64::from(grid.tiles_x(level)) * u64::from(grid.tiles_y(level));
        let share = 100.0 * tiles as f64 / all as f64;
        let _ = writeln!(out, "{level:<5}{nodes:>16}{tiles:>8}{share:>7.1} %{:>14}", size(bytes));
    }
}

/// One line on a source: whatever of the usual keys it has.
fn describe(source: &Value) -> String {
    let text = |key: &str| source.get(key).and_then(Value::as_str).map(str::to_owned);
    let size = match (source.get("width"), source.get("height")) {
        (Some(width), Some(height)) => Some(format!("{width} x {height}")),
        _ => None,
    };
    let parts = [text("file"), text("driver"), size, text("sample_type"), text("crs"), text("registration")];
    let mut line = parts.into_iter().flatten().collect::<Vec<_>>().join(", ");
    if let Some(hash) = text("blake3") {
        let _ = write!(line, "\n              blake3 {hash}");
    }
    if line.is_empty() { source.to_string() } else { line }
}

/// The name inside a WKT text, or the text itself where it has none.
fn crs_name(wkt: &str) -> String {
    match wkt.split('"').nth(1) {
        Some(name) => name.to_owned(),
        None if wkt.is_empty() => "none".into(),
        None => wkt.to_owned(),
    }
}

/// A number of bytes in units a reader can compare.
fn size(bytes: u64) -> String {
    let units = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = bytes as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < units.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 { format!("{bytes} B") } else { format!("{value:.2} {}", units[unit]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn sizes_and_names() {
        assert_eq!([size(0), size(1023), size(1536), size(5 << 40)], ["0 B", "1023 B", "1.50 KiB", "5.00 TiB"]);
        assert_eq!(crs_name(r#"PROJCS["WGS 84 / UTM zone 30N",GEOGCS["WGS 84"]]"#), "WGS 84 / UTM zone 30N");
        assert_eq!(crs_name(""), "none");
        assert_eq!(describe(&json!({ "file": "a.tif", "width": 3, "height": 2 })), "a.tif, 3 x 2");
        assert_eq!(describe(&json!([1])), "[1]");
    }
}
