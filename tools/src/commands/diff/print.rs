//! The comparison as text and as JSON.

use std::fmt::Write as _;

use relief_formats::body::Body;
use relief_formats::file::{Plane, Relief};
use serde_json::{Map, Value, json};

use super::compare::{Comparison, Largest};

/// Where a node is: names and values of its coordinates.
fn place(relief: &Relief, largest: &Largest) -> [(&'static str, f64); 2] {
    let (grid, level, [i, j]) = (relief.grid(), largest.tile.level, largest.node);
    match *relief.body() {
        Body::Ellipsoid { .. } => [
            ("lon_deg", grid.lon_deg(level, i64::from(i % grid.width(level)))),
            ("lat_deg", grid.lat_deg(level, i64::from(j))),
        ],
        Body::Plane { x0, y0, dx, dy, .. } => {
            let scale = f64::from(1u32 << level);
            [("x", x0 + f64::from(i) * scale * dx), ("y", y0 + f64::from(j) * scale * dy)]
        }
    }
}

pub fn json(comparison: &Comparison, relief: &Relief, tolerance_m: f64, different: bool) -> Value {
    let largest = comparison.largest.map(|largest| {
        let mut value = json!({
            "difference_m": largest.difference_m,
            "a_m": largest.a_m,
            "b_m": largest.b_m,
            "level": largest.tile.level,
            "tile": [largest.tile.x, largest.tile.y],
        });
        for (name, coordinate) in place(relief, &largest) {
            value[name] = coordinate.into();
        }
        value
    });
    let levels: Vec<Value> = (0..)
        .zip(&comparison.levels)
        .map(|(k, level): (u32, _)| {
            json!({
                "level": k,
                "tiles": level.tiles,
                "tiles_different": level.different,
                "tiles_only_a": level.only[0],
                "tiles_only_b": level.only[1],
                "nodes_different": level.nodes,
                "largest_m": level.largest_m,
            })
        })
        .collect();
    let planes: Map<String, Value> =
        Plane::ALL.iter().zip(comparison.planes).map(|(plane, tiles)| (plane.name().into(), tiles.into())).collect();
    let facts: Map<String, Value> =
        comparison.facts.iter().map(|(name, [a, b])| ((*name).into(), json!([a, b]))).collect();
    json!({
        "identical": comparison.identical,
        "different": different,
        "tolerance_m": tolerance_m,
        "largest_m": comparison.largest.map_or(0.0, |largest| largest.difference_m.abs()),
        "rms_m": comparison.rms_m,
        "largest": largest,
        "levels": levels,
        "planes": planes,
        "facts": facts,
    })
}

pub fn text(comparison: &Comparison, relief: &Relief, tolerance_m: f64, different: bool) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let verdict = match (comparison.identical, different) {
        (true, _) => "identical content".into(),
        (false, true) => format!("different (tolerance {tolerance_m} m)"),
        (false, false) => format!("equal within {tolerance_m} m"),
    };
    let _ = writeln!(out, "verdict       {verdict}");
    for (name, [a, b]) in &comparison.facts {
        let short = |value: &Value| match value {
            Value::Array(_) | Value::Object(_) => "...".to_owned(),
            Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        match (short(a), short(b)) {
            (a, b) if a == "..." || b == "..." => {
                let _ = writeln!(out, "{name:<14}not the same (see --json)");
            }
            (a, b) => {
                let _ = writeln!(out, "{name:<14}A: {a}  B: {b}");
            }
        }
    }
    if comparison.identical {
        return out;
    }
    match &comparison.largest {
        None => {
            let _ = writeln!(out, "heights       equal at every node");
        }
        Some(largest) => {
            let [(first, x), (second, y)] = place(relief, largest);
            let Largest { difference_m, a_m, b_m, tile, .. } = largest;
            let _ = writeln!(out, "largest       {difference_m} m (A {a_m} m, B {b_m} m)");
            let _ = writeln!(
                out,
                "  at          {first} {x}, {second} {y}; level {}, tile ({}, {})",
                tile.level, tile.x, tile.y
            );
            let _ = writeln!(out, "rms           {:.6} m over all nodes of level 0", comparison.rms_m);
        }
    }
    let _ = writeln!(out, "\nlevel    tiles  different   only A   only B  nodes different     largest");
    for (k, level) in comparison.levels.iter().enumerate() {
        let _ = writeln!(
            out,
            "{k:<5}{:>9}{:>11}{:>9}{:>9}{:>17}{:>10.4} m",
            level.tiles, level.different, level.only[0], level.only[1], level.nodes, level.largest_m
        );
    }
    let planes: Vec<String> =
        Plane::ALL.iter().zip(comparison.planes).map(|(plane, tiles)| format!("{} {tiles}", plane.name())).collect();
    let _ = writeln!(out, "\ntiles whose plane differs: {}", planes.join(", "));
    out
}
