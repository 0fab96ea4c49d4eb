//! What must hold for a patch mesh, checked on its positions rather than on how it was built.

use super::PatchMesh;
use super::surface::check_positions;
use crate::body::Body;
use crate::geodesy::{Ellipsoid, T_NORTH};

/// A rule that a mesh can break.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MeshFault {
    /// An axis is too short, does not climb from edge to edge, or a vertex is more than half a
    /// unit from its texture coordinate.
    Axis,
    /// A triangle names a vertex that does not exist, or the last triangle is cut short.
    IndexRange,
    /// A vertex is off the ellipsoid by more than 1e-9 of its semi-axes (a plane: z is not 0).
    OffBody,
    /// A triangle has two equal corners or no area.
    Degenerate,
    /// A triangle turns its back to the outside.
    Orientation,
    /// An edge has one triangle only (a plane: and does not lie on the square's border).
    Open,
    /// An edge has more than two triangles, or two that run along it the same way.
    NonManifold,
    /// Vertices - edges + triangles is not 2 (a plane: 1) after welding by position.
    Euler,
}

impl MeshFault {
    /// A stable name for reports.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Axis => "mesh-axis",
            Self::IndexRange => "mesh-index-range",
            Self::OffBody => "mesh-off-body",
            Self::Degenerate => "mesh-degenerate",
            Self::Orientation => "mesh-orientation",
            Self::Open => "mesh-open",
            Self::NonManifold => "mesh-non-manifold",
            Self::Euler => "mesh-euler",
        }
    }
}

/// A broken rule: where first, and how often.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFinding {
    /// The rule.
    pub fault: MeshFault,
    /// How many vertices, triangles or edges break it.
    pub count: usize,
    /// The first one, in words and numbers.
    pub detail: String,
    /// Where that is: longitude and latitude in degrees, or x and y of a plane's CRS.
    pub place: Option<[f64; 2]>,
}

/// Checks a mesh on its body; an empty list means that every rule of [`MeshFault`] holds.
#[must_use]
pub fn check_mesh(mesh: &PatchMesh, body: &Body) -> Vec<MeshFinding> {
    let mut findings = Findings::default();
    let span = if body.is_plane() { u64::from(T_NORTH) } else { 1 << 32 };
    check_axis(&mesh.s_axis, span, "s", &mut findings);
    check_axis(&mesh.t_axis, u64::from(T_NORTH), "t", &mut findings);
    if !findings.0.is_empty() {
        return findings.0; // positions would mean nothing
    }
    let border = match *body {
        Body::Ellipsoid { .. } => None,
        Body::Plane { .. } => Some([mesh.place(body, 0, 0), mesh.place(body, T_NORTH, T_NORTH)]),
    };
    check_positions(&mesh.positions(body), &mesh.indices, Ellipsoid::of(body), border, &mut findings);
    findings.0
}

/// The rules from [`MeshFault::IndexRange`] on, for any triangles on an ellipsoid: ECEF metres,
/// three vertex numbers a triangle. Vertices at equal positions count as one.
#[must_use]
pub fn check_surface(positions_m: &[[f64; 3]], indices: &[u32], ellipsoid: &Ellipsoid) -> Vec<MeshFinding> {
    let mut findings = Findings::default();
    check_positions(positions_m, indices, Some(*ellipsoid), None, &mut findings);
    findings.0
}

#[derive(Default)]
pub(super) struct Findings(Vec<MeshFinding>);

impl Findings {
    pub(super) fn add(&mut self, fault: MeshFault, place: Option<[f64; 2]>, detail: impl FnOnce() -> String) {
        match self.0.iter_mut().find(|finding| finding.fault == fault) {
            Some(finding) => finding.count += 1,
            None => self.0.push(MeshFinding { fault, count: 1, detail: detail(), place }),
        }
    }
}

fn check_axis(axis: &[u32], span: u64, name: &str, findings: &mut Findings) {
    let Some(cells) = axis.len().checked_sub(1).filter(|&cells| cells > 0) else {
        findings.add(MeshFault::Axis, None, || format!("{name} axis has {} values, needs at least 2", axis.len()));
        return;
    };
    for (k, &value) in axis.iter().enumerate() {
        // cells * value against k * span: exact in 128 bits, compared on the circle when s wraps.
        let (scaled, exact) = (cells as i128 * i128::from(value), k as i128 * i128::from(span));
        let turn = if span > u64::from(u32::MAX) { cells as i128 * i128::from(span) } else { i128::MAX / 4 };
        let off = (scaled - exact).rem_euclid(turn);
        if 2 * off.min(turn - off) > cells as i128 {
            findings.add(MeshFault::Axis, None, || {
                format!("{name} axis: value {k} is {value}, more than half a unit from {k} / {cells} of {span}")
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MeshLayout, patch_mesh};
    use super::*;
    use crate::grid::Grid;

    fn earth() -> Ellipsoid {
        Ellipsoid::of(&Body::earth()).unwrap()
    }

    fn small() -> (Vec<[f64; 3]>, Vec<u32>) {
        let mesh = patch_mesh(&Body::earth(), &Grid::new(8, false), MeshLayout::Aligned);
        (mesh.positions(&Body::earth()), mesh.indices)
    }

    fn faults(findings: &[MeshFinding]) -> Vec<MeshFault> {
        findings.iter().map(|finding| finding.fault).collect()
    }

    fn faults_of(positions: &[[f64; 3]], indices: &[u32]) -> Vec<MeshFault> {
        faults(&check_surface(positions, indices, &earth()))
    }

    #[test]
    fn every_mesh_that_is_built_passes() {
        let prolate = Body::Ellipsoid { name: "3,9".into(), a_m: 3.0, b_m: 9.0 };
        let plane = Body::Plane { crs_wkt: String::new(), x0: 500_000.3, y0: 4e6, dx: 30.0, dy: 29.9 };
        for m in 8..=14 {
            for body in [Body::earth(), Body::moon(), Body::mars(), prolate.clone(), plane.clone()] {
                for layout in [MeshLayout::Aligned, MeshLayout::Paper] {
                    let mesh = patch_mesh(&body, &Grid::new(m, body.is_plane()), layout);
                    assert_eq!(check_mesh(&mesh, &body), [], "m = {m}, {layout:?}, {body:?}");
                }
            }
        }
    }

    #[test]
    fn a_missing_triangle_opens_the_surface() {
        let (positions, indices) = small();
        let findings = check_surface(&positions, &indices[3..], &earth());
        assert_eq!(faults(&findings), [MeshFault::Open, MeshFault::Euler]);
        assert_eq!(findings[0].count, 3);
        assert!((findings[0].place.unwrap()[1] + 90.0).abs() < 1e-9, "{findings:?}");
    }

    #[test]
    fn a_triangle_twice_is_no_surface() {
        let (positions, mut indices) = small();
        indices.extend_from_within(..3);
        assert_eq!(faults_of(&positions, &indices), [MeshFault::NonManifold, MeshFault::Euler]);
    }

    #[test]
    fn a_turned_triangle_faces_inwards() {
        let (positions, mut indices) = small();
        indices.swap(60, 61);
        assert_eq!(faults_of(&positions, &indices), [MeshFault::Orientation, MeshFault::NonManifold]);
    }

    #[test]
    fn a_mesh_inside_out_faces_inwards() {
        let (positions, mut indices) = small();
        indices.as_chunks_mut::<3>().0.iter_mut().for_each(|triangle| triangle.reverse());
        assert_eq!(faults_of(&positions, &indices), [MeshFault::Orientation]);
    }

    #[test]
    fn a_lifted_vertex_is_off_the_body() {
        let (mut positions, indices) = small();
        // Vertex 20 lies inside the map; 0.02 m up is 3e-9 of the radius.
        positions[20] = positions[20].map(|x| x * (1.0 + 3e-9));
        assert_eq!(faults_of(&positions, &indices), [MeshFault::OffBody]);
        positions[20] = [f64::NAN; 3];
        assert!(faults_of(&positions, &indices).contains(&MeshFault::OffBody));
    }

    #[test]
    fn equal_corners_have_no_area() {
        let (positions, mut indices) = small();
        indices[61] = indices[60];
        assert!(faults_of(&positions, &indices).contains(&MeshFault::Degenerate));
    }

    #[test]
    fn indices_must_name_vertices() {
        let (positions, mut indices) = small();
        indices[0] = positions.len() as u32;
        assert!(faults_of(&positions, &indices).contains(&MeshFault::IndexRange));
        let (positions, indices) = small();
        assert!(faults_of(&positions, &indices[..indices.len() - 1]).contains(&MeshFault::IndexRange));
    }

    #[test]
    fn two_closed_surfaces_are_not_one() {
        let octahedron = |turn_deg: f64, tilt: bool| {
            let (a, b) = (earth().a_m, earth().b_m);
            let (sin, cos) = turn_deg.to_radians().sin_cos();
            [[a, 0.0, 0.0], [0.0, a, 0.0], [-a, 0.0, 0.0], [0.0, -a, 0.0], [0.0, 0.0, a], [0.0, 0.0, -a]].map(
                |[x, y, z]| {
                    let [x, z] = if tilt { [0.6 * x - 0.8 * z, 0.8 * x + 0.6 * z] } else { [x, z] };
                    [x * cos - y * sin, x * sin + y * cos, z * b / a]
                },
            )
        };
        let faces: Vec<u32> = vec![0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5];
        let one = octahedron(0.0, false).to_vec();
        assert_eq!(faults_of(&one, &faces), []);
        let two = [one, octahedron(20.0, true).to_vec()].concat();
        let both: Vec<u32> = faces.iter().copied().chain(faces.iter().map(|v| v + 6)).collect();
        assert_eq!(faults_of(&two, &both), [MeshFault::Euler]);
    }

    #[test]
    fn an_axis_that_strays_is_named() {
        let body = Body::earth();
        let good = patch_mesh(&body, &Grid::new(9, false), MeshLayout::Paper);
        let strays = |change: fn(&mut PatchMesh)| {
            let mut mesh = good.clone();
            change(&mut mesh);
            faults(&check_mesh(&mesh, &body))
        };
        assert_eq!(strays(|_| ()), []);
        assert_eq!(strays(|mesh| mesh.s_axis[3] += 1), [MeshFault::Axis]);
        assert_eq!(strays(|mesh| mesh.s_axis[0] = u32::MAX), [MeshFault::Axis]);
        assert_eq!(strays(|mesh| mesh.t_axis[7] += 1), [MeshFault::Axis]);
        assert_eq!(strays(|mesh| mesh.t_axis.swap(2, 3)), [MeshFault::Axis]);
        assert_eq!(strays(|mesh| mesh.t_axis.clear()), [MeshFault::Axis]);
        let plane = Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: 1.0, dy: 1.0 };
        assert_eq!(faults(&check_mesh(&good, &plane)), [MeshFault::Axis]);
    }

    #[test]
    fn a_hole_in_a_plane_is_no_border() {
        let plane = Body::Plane { crs_wkt: String::new(), x0: 0.1, y0: 0.2, dx: 1.3, dy: 1.0 };
        let mut mesh = patch_mesh(&plane, &Grid::new(8, true), MeshLayout::Aligned);
        mesh.indices.drain(30..36);
        assert_eq!(faults(&check_mesh(&mesh, &plane)), [MeshFault::Open, MeshFault::Euler]);
    }
}
