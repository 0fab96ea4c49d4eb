//! Rules on triangles in space, whatever mesh they come from.

use std::collections::HashMap;

use super::check::{Findings, MeshFault};
use crate::geodesy::Ellipsoid;

/// Largest departure from the ellipsoid, relative to its semi-axes.
const ON_BODY: f64 = 1e-9;
/// A triangle whose doubled area is below this share of its longest side squared is degenerate.
const FLAT: f64 = 1e-12;

/// Range, place, area, orientation, closure and Euler characteristic, in this order; `ellipsoid` is
/// none for a plane, whose square then has the corners `border`.
pub(super) fn check_positions(
    positions: &[[f64; 3]],
    indices: &[u32],
    ellipsoid: Option<Ellipsoid>,
    border: Option<[[f64; 2]; 2]>,
    findings: &mut Findings,
) {
    let place = |p: [f64; 3]| match ellipsoid {
        Some(body) => {
            let at = body.geodetic_from_ecef(p);
            Some([at.lon_rad.to_degrees(), at.lat_rad.to_degrees()])
        }
        None => Some([p[0], p[1]]),
    };
    for (v, &p) in positions.iter().enumerate() {
        let off = ellipsoid.map_or(p[2].abs(), |body| body.implicit(p).abs() / 2.0);
        if off.is_nan() || off > ON_BODY {
            findings
                .add(MeshFault::OffBody, place(p), || format!("vertex {v} is off the body by {off:.3e} of its radius"));
        }
    }
    let (triangles, rest) = indices.as_chunks::<3>();
    if !rest.is_empty() {
        findings.add(MeshFault::IndexRange, None, || format!("{} indices are no multiple of 3", indices.len()));
    }
    let welded = weld(positions);
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::with_capacity(triangles.len() * 3 / 2);
    let mut used = vec![false; positions.len()];
    let mut faces = 0i64;
    for (number, corners) in triangles.iter().enumerate() {
        let [Some(&a), Some(&b), Some(&c)] = corners.map(|v| positions.get(v as usize)) else {
            findings.add(MeshFault::IndexRange, None, || {
                format!("triangle {number} names vertices {corners:?}, there are {}", positions.len())
            });
            continue;
        };
        faces += 1;
        let ids = corners.map(|v| welded[v as usize]);
        let normal = cross(sub(b, a), sub(c, a));
        let longest = [sub(b, a), sub(c, a), sub(c, b)].into_iter().map(|d| dot(d, d)).fold(0.0, f64::max);
        let flat = ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0];
        let has_area = dot(normal, normal).sqrt() > FLAT * longest; // false for not-a-number
        if flat || !has_area {
            findings.add(MeshFault::Degenerate, place(a), || format!("triangle {number} {corners:?} has no area"));
        } else {
            let outwards = if ellipsoid.is_some() { add(a, add(b, c)) } else { [0.0, 0.0, 1.0] };
            if dot(normal, outwards) <= 0.0 {
                findings
                    .add(MeshFault::Orientation, place(a), || format!("triangle {number} {corners:?} faces inwards"));
            }
        }
        for (from, to) in [(ids[0], ids[1]), (ids[1], ids[2]), (ids[2], ids[0])] {
            used[from as usize] = true;
            let way = usize::from(from > to);
            edges.entry([from.min(to), from.max(to)]).or_default()[way] += 1;
        }
    }
    // In the order of vertex numbers, so that the same mesh gives the same words.
    let mut faulty: Vec<_> = edges.iter().filter(|(_, ways)| **ways != [1, 1]).collect();
    faulty.sort_unstable();
    for (&[u, v], &ways) in faulty {
        let (p, q) = (positions[u as usize], positions[v as usize]);
        if ways[0] + ways[1] > 1 {
            findings.add(MeshFault::NonManifold, place(p), || {
                format!("edge {u} - {v} has {} triangles one way and {} the other", ways[0], ways[1])
            });
        } else if !border.is_some_and(|corners| on_border(p, q, corners)) {
            findings.add(MeshFault::Open, place(p), || format!("edge {u} - {v} has one triangle"));
        }
    }
    let vertices = used.iter().filter(|&&used| used).count() as i64;
    let (euler, expected) = (vertices - edges.len() as i64 + faces, if ellipsoid.is_some() { 2 } else { 1 });
    if euler != expected {
        findings.add(MeshFault::Euler, None, || {
            format!("{vertices} vertices - {} edges + {faces} triangles = {euler}, must be {expected}", edges.len())
        });
    }
}

/// The first vertex at each vertex's position, by equal bits.
fn weld(positions: &[[f64; 3]]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    let bits = |p: &[f64; 3]| p.map(|x| (x + 0.0).to_bits());
    positions.iter().enumerate().map(|(v, p)| *first.entry(bits(p)).or_insert(v as u32)).collect()
}

fn on_border(p: [f64; 3], q: [f64; 3], [low, high]: [[f64; 2]; 2]) -> bool {
    (0..2).any(|axis| p[axis] == q[axis] && (p[axis] == low[axis] || p[axis] == high[axis]))
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
