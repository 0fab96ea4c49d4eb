//! Triangles cut to what a rasteriser can hold: in front of the near plane, and within the guard
//! band, where snapped coordinates still multiply exactly.

/// A vertex in clip space with its weights at the triangle's corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// x, y, w; z is the distance of the near plane.
    pub clip: [f32; 3],
    pub weights: [f32; 3],
}

/// Vertices of a triangle cut by five planes.
pub(super) type Polygon = Vec<Vertex>;

/// Half-spaces that hold when x . clip >= offset: w >= near, and |x|, |y| <= guard w.
pub(super) fn clip(corners: [Vertex; 3], near: f32, guard: f32) -> Polygon {
    let planes: [([f32; 3], f32); 5] = [
        ([0.0, 0.0, 1.0], near),
        ([1.0, 0.0, guard], 0.0),
        ([-1.0, 0.0, guard], 0.0),
        ([0.0, 1.0, guard], 0.0),
        ([0.0, -1.0, guard], 0.0),
    ];
    let mut polygon = corners.to_vec();
    for (normal, offset) in planes {
        let side = |v: &Vertex| normal[0] * v.clip[0] + normal[1] * v.clip[1] + normal[2] * v.clip[2] - offset;
        if polygon.iter().all(|v| side(v) >= 0.0) {
            continue;
        }
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (k, a) in polygon.iter().enumerate() {
            let b = &polygon[(k + 1) % polygon.len()];
            let (at_a, at_b) = (side(a), side(b));
            if at_a >= 0.0 {
                kept.push(*a);
            }
            if (at_a >= 0.0) != (at_b >= 0.0) {
                // From inside to outside, so that both triangles of an edge cut it alike.
                let (inside, outside, near_side, far_side) =
                    if at_a >= 0.0 { (a, b, at_a, at_b) } else { (b, a, at_b, at_a) };
                let share = near_side / (near_side - far_side);
                let between = |u: [f32; 3], v: [f32; 3]| std::array::from_fn(|i| u[i] + (v[i] - u[i]) * share);
                kept.push(Vertex {
                    clip: between(inside.clip, outside.clip),
                    weights: between(inside.weights, outside.weights),
                });
            }
        }
        polygon = kept;
        if polygon.is_empty() {
            break;
        }
    }
    polygon
}
