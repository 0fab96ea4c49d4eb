//! The ellipsoid patch mesh (PME, paper 000, Algorithm 1): what adaptive tessellation starts from.
//!
//! The mesh is a product grid: `columns` x `rows` cells between meridians `s_axis` and parallels
//! `t_axis`. Vertex (i, j), i northwards, j eastwards, has number i (columns + 1) + j and texture
//! coordinates exactly (j / columns, i / rows). On a globe the last column repeats the positions
//! of column 0 with s = 1, and each pole is one vertex per column for its texture coordinates.

mod check;
mod codec;
mod surface;

pub use check::{MeshFault, MeshFinding, check_mesh, check_surface};
pub use codec::{MAX_CELLS, MAX_SECTION_BYTES, MeshError, decode, decode_section, encode, encode_section};

use crate::body::Body;
use crate::geodesy::{Ellipsoid, T_NORTH, lat_deg, lon_deg};
use crate::grid::Grid;

/// Level-0 cells along a patch's side in the aligned layout, while m <= 13.
pub const PATCH_CELLS: u32 = 64;
/// From this exponent on the mesh keeps its counts and the patches grow.
const LARGEST_M: u32 = 13;

/// Where the mesh has its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshLayout {
    /// On nodes: 2^(m-5) x 2^(m-6) cells of 64 x 64 level-0 cells, at most 256 x 128.
    Aligned,
    /// The counts of Algorithm 1: 2^(m-5) - 1 x 2^(m-6) - 1 cells, at most 255 x 127. Vertices
    /// fall between nodes; their S and T are rounded to the nearest unit, at most half a unit
    /// (4.7 mm on Earth) from the exact texture coordinate.
    Paper,
}

/// A vertex of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchVertex {
    /// Fixed-point longitude; 0 at both ends of a globe's row.
    pub s: u32,
    /// Fixed-point latitude.
    pub t: u32,
    /// Texture coordinates (s, t), each 0 to 1.
    pub tex: [f64; 2],
}

/// The patch mesh. Triangles are counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PatchMesh {
    /// Where the vertices are.
    pub layout: MeshLayout,
    /// The map exponent.
    pub m: u32,
    /// Fixed-point S of the columns + 1 meridians, westernmost first.
    pub s_axis: Vec<u32>,
    /// Fixed-point T of the rows + 1 parallels, southernmost first.
    pub t_axis: Vec<u32>,
    /// Three vertex numbers a triangle, in the order of Algorithm 1.
    pub indices: Vec<u32>,
}

/// Builds the patch mesh. `grid.m` is at least 8; what is smaller gets the mesh of m = 8.
///
/// A plane has 64 x 64-cell patches over its whole square (at most 128 x 128 of them), two
/// triangles each, no seam and no poles; it is always aligned.
#[must_use]
pub fn patch_mesh(body: &Body, grid: &Grid, layout: MeshLayout) -> PatchMesh {
    let m = grid.m.clamp(8, LARGEST_M);
    let plane = body.is_plane();
    let layout = if plane { MeshLayout::Aligned } else { layout };
    let (columns, rows) = match layout {
        MeshLayout::Aligned => (1 << (m - 5 - u32::from(plane)), 1 << (m - 6)),
        MeshLayout::Paper => ((1 << (m - 5)) - 1, (1 << (m - 6)) - 1),
    };
    let columns_span = if plane { u64::from(T_NORTH) } else { 1 << 32 };
    PatchMesh {
        layout,
        m: grid.m,
        s_axis: axis(columns_span, columns),
        t_axis: axis(u64::from(T_NORTH), rows),
        indices: if plane { plane_indices(columns, rows) } else { globe_indices(columns, rows) },
    }
}

/// round(k span / cells), k = 0..=cells, modulo 2^32.
fn axis(span: u64, cells: u32) -> Vec<u32> {
    let cells = u64::from(cells);
    (0..=cells).map(|k| ((2 * k * span + cells) / (2 * cells)) as u32).collect()
}

/// Algorithm 1: `columns` = n_mer, `rows` = n_par - 1. The first row of pairs is the two polar
/// triangles of each column, the others are the quads between.
fn globe_indices(columns: u32, rows: u32) -> Vec<u32> {
    let stride = columns + 1;
    let mut indices = Vec::with_capacity(6 * columns as usize * (rows as usize - 1));
    for j in 0..columns {
        let north = (rows - 1) * stride + j;
        indices.extend([j, stride + j + 1, stride + j, north, north + 1, north + stride]);
    }
    for i in 1..rows - 1 {
        for j in 0..columns {
            push_quad(&mut indices, i * stride + j, stride);
        }
    }
    indices
}

fn plane_indices(columns: u32, rows: u32) -> Vec<u32> {
    let stride = columns + 1;
    let mut indices = Vec::with_capacity(6 * columns as usize * rows as usize);
    for i in 0..rows {
        for j in 0..columns {
            push_quad(&mut indices, i * stride + j, stride);
        }
    }
    indices
}

fn push_quad(indices: &mut Vec<u32>, corner: u32, stride: u32) {
    let north = corner + stride;
    indices.extend([corner, corner + 1, north, north + 1, north, corner + 1]);
}

impl PatchMesh {
    /// Cells from west to east.
    #[must_use]
    pub fn columns(&self) -> u32 {
        self.s_axis.len().saturating_sub(1) as u32
    }

    /// Cells from south to north.
    #[must_use]
    pub fn rows(&self) -> u32 {
        self.t_axis.len().saturating_sub(1) as u32
    }

    /// (columns + 1) (rows + 1).
    #[must_use]
    pub fn vertex_count(&self) -> u32 {
        (self.s_axis.len() as u32).saturating_mul(self.t_axis.len() as u32)
    }

    /// Vertex `v`, or none when there is no such vertex.
    #[must_use]
    pub fn vertex(&self, v: u32) -> Option<PatchVertex> {
        let stride = self.s_axis.len() as u32;
        let (j, i) = (v.checked_rem(stride)?, v.checked_div(stride)?);
        Some(PatchVertex {
            s: *self.s_axis.get(j as usize)?,
            t: *self.t_axis.get(i as usize)?,
            tex: [f64::from(j) / f64::from(self.columns()), f64::from(i) / f64::from(self.rows())],
        })
    }

    /// All vertices in the order of their numbers.
    pub fn vertices(&self) -> impl Iterator<Item = PatchVertex> + '_ {
        (0..self.vertex_count()).filter_map(|v| self.vertex(v))
    }

    /// Triangles as three vertex numbers.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.indices.as_chunks().0.iter().copied()
    }

    /// Where a vertex is at a height above the body, f64: ECEF metres, error about 2e-9 m on
    /// Earth; on a plane (x, y) in the units of its CRS and z = height.
    #[must_use]
    pub fn position(&self, body: &Body, vertex: PatchVertex, height_m: f64) -> [f64; 3] {
        match (Ellipsoid::of(body), body) {
            (Some(ellipsoid), _) => ellipsoid.ecef_from_fixed_m(vertex.s, vertex.t, height_m),
            (None, _) => {
                let [x, y] = self.place(body, vertex.s, vertex.t);
                [x, y, height_m]
            }
        }
    }

    /// Positions of all vertices on the body, see [`PatchMesh::position`].
    #[must_use]
    pub fn positions(&self, body: &Body) -> Vec<[f64; 3]> {
        self.vertices().map(|vertex| self.position(body, vertex, 0.0)).collect()
    }

    /// Longitude and latitude in degrees, or x and y in the units of a plane's CRS.
    #[must_use]
    pub fn place(&self, body: &Body, s: u32, t: u32) -> [f64; 2] {
        match *body {
            Body::Ellipsoid { .. } => [lon_deg(s), lat_deg(t)],
            Body::Plane { x0, y0, dx, dy, .. } => {
                let nodes = f64::from(1u32 << self.m.min(31)) / f64::from(T_NORTH);
                [x0 + f64::from(s) * nodes * dx, y0 + f64::from(t) * nodes * dy]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::node_of;

    fn globe(m: u32, layout: MeshLayout) -> PatchMesh {
        patch_mesh(&Body::earth(), &Grid::new(m, false), layout)
    }

    #[test]
    fn counts_follow_the_exponent() {
        for (m, columns, rows) in [(8, 8, 4), (9, 16, 8), (13, 256, 128), (14, 256, 128), (20, 256, 128)] {
            let mesh = globe(m, MeshLayout::Aligned);
            assert_eq!((mesh.columns(), mesh.rows()), (columns, rows), "m = {m}");
            assert_eq!(mesh.indices.len() as u32, 6 * columns * (rows - 1));
            assert_eq!(mesh.vertex_count(), (columns + 1) * (rows + 1));
        }
        for (m, columns, rows) in [(8, 7, 3), (9, 15, 7), (13, 255, 127), (20, 255, 127)] {
            let mesh = globe(m, MeshLayout::Paper);
            assert_eq!((mesh.columns(), mesh.rows()), (columns, rows), "m = {m}");
            assert_eq!(mesh.indices.len() as u32, 6 * columns * (rows - 1));
        }
    }

    #[test]
    fn aligned_vertices_are_nodes_and_paper_ones_are_near() {
        for m in 8..=20 {
            let mesh = globe(m, MeshLayout::Aligned);
            let grid = Grid::new(m, false);
            assert!(mesh.vertices().all(|v| node_of(grid, 0, v.s).is_some() && node_of(grid, 0, v.t).is_some()));
            let paper = globe(m, MeshLayout::Paper);
            for v in paper.vertices() {
                let off_s = (f64::from(v.s) - v.tex[0] * 4_294_967_296.0).rem_euclid(4_294_967_296.0);
                assert!(off_s.min(4_294_967_296.0 - off_s) <= 0.5 + 1e-6);
                assert!((f64::from(v.t) - v.tex[1] * 2_147_483_648.0).abs() <= 0.5 + 1e-6);
            }
        }
    }

    #[test]
    fn algorithm_1_by_hand() {
        let mesh = globe(8, MeshLayout::Paper);
        // n_mer = 7, n_par = 4, M = 8.
        assert_eq!(mesh.indices[..12], [0, 9, 8, 16, 17, 24, 1, 10, 9, 17, 18, 25]);
        assert_eq!(mesh.indices[42..48], [8, 9, 16, 17, 16, 9]);
    }

    #[test]
    fn seam_and_poles_keep_their_texture_coordinates() {
        let mesh = globe(8, MeshLayout::Aligned);
        let (west, east) = (mesh.vertex(9).unwrap(), mesh.vertex(17).unwrap());
        assert_eq!((west.tex[0], east.tex[0]), (0.0, 1.0));
        let body = Body::earth();
        assert_eq!(mesh.position(&body, west, 0.0), mesh.position(&body, east, 0.0));
        let Body::Ellipsoid { b_m, .. } = body else { unreachable!() };
        for j in 0..=8 {
            let pole = mesh.vertex(4 * 9 + j).unwrap();
            assert_eq!(pole.tex, [f64::from(j) / 8.0, 1.0]);
            let [x, y, z] = mesh.position(&body, pole, 0.0);
            assert!(x == 0.0 && y == 0.0 && (z - b_m).abs() < 2e-9);
        }
        assert_eq!(mesh.vertex(45), None);
    }

    #[test]
    fn a_plane_covers_its_square() {
        let body = Body::Plane { crs_wkt: String::new(), x0: 500.0, y0: -40.0, dx: 2.0, dy: 3.0 };
        let mesh = patch_mesh(&body, &Grid::new(9, true), MeshLayout::Paper);
        assert_eq!((mesh.layout, mesh.columns(), mesh.rows()), (MeshLayout::Aligned, 8, 8));
        let corner = mesh.position(&body, mesh.vertex(80).unwrap(), 7.0);
        assert_eq!(corner, [500.0 + 1024.0, -40.0 + 1536.0, 7.0]);
        assert_eq!(mesh.position(&body, mesh.vertex(1).unwrap(), 0.0), [628.0, -40.0, 0.0]);
    }
}
