//! Neighbouring strips in step.

use multiversion::multiversion;

use super::slab::{Piece, Slab};

/// Strips in step.
pub const LANES: usize = 16;
/// A height below all relief, metres.
pub const DEEP: f32 = -1.0e30;

/// A value for each of some neighbouring strips.
pub type Lanes = [f32; LANES];

/// The values from place `at` on.
#[inline(always)]
pub fn lanes(values: &[f32], at: usize) -> Lanes {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&values[at..at + LANES]);
    out
}

/// The patch along a piece, less the climb in the slab, as a quadratic in the share of the slab.
#[inline(always)]
pub fn quadratic(heights: [&[f32]; 2], piece: &Piece, climb_m: f32, at: usize) -> [Lanes; 3] {
    let near = at.wrapping_add_signed(piece.near);
    let far = at.wrapping_add_signed(piece.far);
    let (h00, h10) = (lanes(heights[0], near), lanes(heights[0], near + 1));
    let (h01, h11) = (lanes(heights[1], far), lanes(heights[1], far + 1));
    let mut out = [[0.0; LANES]; 3];
    for i in 0..LANES {
        let (a, b) = (h10[i] - h00[i], h01[i] - h00[i]);
        let d = (h11[i] - h01[i]) - a;
        out[0][i] = h00[i] + piece.left * a;
        out[1][i] = piece.shear * a + b + piece.left * d - climb_m;
        out[2][i] = piece.shear * d;
    }
    out
}

/// Heights along the left side of each strip: at the near row line, and the greatest of the slab
/// less the climb in it.
#[inline(always)]
fn side(heights: [&[f32]; 2], far: &Slab, climb_m: f32, at: usize) -> [Lanes; 2] {
    let mut line = [0.0; LANES];
    let mut most = [DEEP; LANES];
    for (k, piece) in far.pieces[..far.count].iter().enumerate() {
        let [c0, c1, c2] = quadratic(heights, piece, climb_m, at);
        // A parabola rises above its chord by no more.
        let bump = 0.25 * (piece.to - piece.from) * (piece.to - piece.from);
        for i in 0..LANES {
            let from = c0[i] + piece.from * (c1[i] + piece.from * c2[i]);
            let to = c0[i] + piece.to * (c1[i] + piece.to * c2[i]);
            most[i] = most[i].max(from.max(to) + bump * (-c2[i]).max(0.0));
            if k == 0 {
                line[i] = from;
            }
        }
    }
    [line, most]
}

/// Bounds of `strips` strips from place `first` on: the greatest level that the relief reaches in
/// a slab, and in `below` the level that it reaches in every part of a strip.
///
/// In a strip the patches are greatest on its sides or at its nodes, and least on a row line at
/// one of the three.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn bound_row(
    [first, strips]: [usize; 2],
    heights: [&[f32]; 2],
    far: &Slab,
    [climb_m, base_m, slack_m]: [f32; 3],
    greatest: &mut [f32],
    below: &mut [f32],
) {
    for chunk in 0..strips / LANES {
        let at = first + chunk * LANES;
        let [line, most] = side(heights, far, climb_m, at);
        let [next_line, next_most] = side(heights, far, climb_m, at + 1);
        let (near, node) = (lanes(heights[0], at), lanes(heights[1], at));
        let old = lanes(below, at);
        for i in 0..LANES {
            let top = most[i].max(next_most[i]).max(near[i].max(node[i] - climb_m));
            greatest[at + i] = top - base_m + slack_m;
            below[at + i] = old[i].max(line[i].min(next_line[i]).min(near[i]) - base_m - slack_m);
        }
    }
}
