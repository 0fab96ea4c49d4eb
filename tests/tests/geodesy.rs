//! Positions against GeographicLib's CartConvert, mesh edges against geodesics.

#![allow(clippy::unwrap_used, reason = "a test ends at the first thing that goes wrong")]

use std::io::Write as _;
use std::process::{Command, Stdio};

use geographiclib_rs::{Geodesic, InverseGeodesic as _};
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;
use relief_formats::body::Body;
use relief_formats::geodesy::{Ellipsoid, Geodetic, lat_deg, lon_deg, s_from_lon_deg};
use relief_formats::grid::Grid;
use relief_formats::mesh::{MeshLayout, patch_mesh};

/// Runs CartConvert over lines of numbers. A missing program fails the test: this is the only
/// witness that does not come from this project.
fn cart_convert(arguments: &[String], rows: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut child = Command::new("CartConvert")
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("CartConvert is not installed: apt-get install geographiclib-tools");
    let text: String = rows.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let mut input = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    assert!(output.status.success(), "CartConvert failed: {output:?}");
    let parsed: Vec<[f64; 3]> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| {
            let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        })
        .collect();
    assert_eq!(parsed.len(), rows.len());
    parsed
}

/// Bodies with CartConvert's options for them: equatorial radius and flattening.
fn bodies() -> Vec<(Ellipsoid, Vec<String>)> {
    let prolate = Body::Ellipsoid { name: "prolate".into(), a_m: 9.0e5, b_m: 1.1e6 };
    [Body::earth(), Body::moon(), Body::mars(), prolate]
        .iter()
        .filter_map(Ellipsoid::of)
        .map(|body| {
            let flattening = (body.a_m - body.b_m) / body.a_m;
            let options = ["-e".into(), body.a_m.to_string(), flattening.to_string(), "-p".into(), "9".into()];
            (body, options.to_vec())
        })
        .collect()
}

/// 1000 places as (lat, lon, height_m), the poles, the antimeridian and the equator among them.
fn places() -> Vec<[f64; 3]> {
    let mut rows = vec![];
    for lat in [-90.0, -89.999_999_9, -45.0, 0.0, 1e-9, 45.0, 89.999_999_9, 90.0] {
        for lon in [-180.0, -179.999_999_9, -90.0, 0.0, 90.0, 123.456, 179.999_999_9] {
            rows.push([lat, lon, -11_000.0]);
        }
    }
    let mut runner = TestRunner::deterministic();
    let random = (-90.0..90.0f64, -180.0..180.0f64, -11_000.0..400_000.0f64);
    while rows.len() < 1000 {
        let (lat, lon, height_m) = random.new_tree(&mut runner).unwrap().current();
        rows.push([lat, lon, height_m]);
    }
    rows
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2])
}

#[test]
fn ecef_agrees_with_geographiclib() {
    for (body, options) in bodies() {
        let rows = places();
        let theirs = cart_convert(&options, &rows);
        for (&[lat, lon, height_m], &their) in rows.iter().zip(&theirs) {
            let ours = body.ecef_from_deg_m(lon, lat, height_m);
            assert!(distance(ours, their) < 5e-9, "{lat} {lon} {height_m}: {ours:?} {their:?}");
            let at = Geodetic { lon_rad: lon.to_radians(), lat_rad: lat.to_radians(), height_m };
            assert!(distance(body.ecef_m(at), their) < 5e-9, "{lat} {lon} in radians");
        }
    }
}

#[test]
fn geodetic_agrees_with_geographiclib() {
    for (body, mut options) in bodies() {
        let points: Vec<_> = places().iter().map(|&[lat, lon, h]| body.ecef_from_deg_m(lon, lat, h)).collect();
        options.insert(0, "-r".into());
        for (&point, their) in points.iter().zip(cart_convert(&options, &points)) {
            let ours = body.geodetic_from_ecef(point);
            // CartConvert prints nine decimals of a metre and fourteen of a degree.
            assert!((ours.height_m - their[2]).abs() < 5e-9, "{point:?}: {ours:?} {their:?}");
            assert!((ours.lat_rad - their[0].to_radians()).abs() < 2e-15, "{point:?}: {ours:?} {their:?}");
            // At the pole itself any longitude is right.
            let rho_m = point[0].hypot(point[1]);
            let apart = (ours.lon_rad - their[1].to_radians()).rem_euclid(std::f64::consts::TAU);
            let arc_m = apart.min(std::f64::consts::TAU - apart) * rho_m;
            assert!(arc_m < 1e-8, "{point:?}: {ours:?} {their:?}");
        }
    }
}

#[test]
fn mesh_edges_are_chords_of_their_geodesics() {
    let body = Body::earth();
    let ellipsoid = Ellipsoid::of(&body).unwrap();
    let geodesic = Geodesic::wgs84();
    // A geodesic's curvature is a normal curvature: its radius lies between b^2 / a and a^2 / b,
    // and the chord between those of the two circles (Schur).
    let (tight_m, wide_m) = (ellipsoid.b_m.powi(2) / ellipsoid.a_m, ellipsoid.a_m.powi(2) / ellipsoid.b_m);
    // The longest edges are the diagonals at the equator: a share of theta^2 / 24.
    let chord_m = |radius_m: f64, arc_m: f64| 2.0 * radius_m * (arc_m / (2.0 * radius_m)).sin();
    for (m, largest_share) in [(8, 0.05), (10, 3.3e-3), (11, 8.2e-4), (13, 5.2e-5)] {
        let mesh = patch_mesh(&body, &Grid::new(m, false), MeshLayout::Aligned);
        let positions = mesh.positions(&body);
        let vertices: Vec<_> = mesh.vertices().collect();
        for (number, [a, b, c]) in mesh.triangles().enumerate() {
            if m == 13 && number % 16 != 0 {
                continue; // every sixteenth is enough of 65 024
            }
            for (u, v) in [(a, b), (b, c), (c, a)] {
                let (p, q) = (vertices[u as usize], vertices[v as usize]);
                let arc_m: f64 = geodesic.inverse(lat_deg(p.t), lon_deg(p.s), lat_deg(q.t), lon_deg(q.s));
                let chord = distance(positions[u as usize], positions[v as usize]);
                let (low, high) = (chord_m(tight_m, arc_m) - 1e-7, chord_m(wide_m, arc_m) + 1e-7);
                assert!((low..=high).contains(&chord), "m {m}, triangle {number}: {low} {chord} {high}");
                assert!(chord <= arc_m + 1e-7 && (arc_m - chord) / arc_m <= largest_share, "m {m}, triangle {number}");
            }
        }
    }
}

#[test]
fn a_unit_is_9_mm_of_the_equator() {
    let geodesic = Geodesic::wgs84();
    let s = s_from_lon_deg(12.5).unwrap();
    let arc_m: f64 = geodesic.inverse(0.0, lon_deg(s), 0.0, lon_deg(s + 1));
    assert!((arc_m - 0.009_330).abs() < 1e-5, "{arc_m}");
}
