// The bilinear patch of a cell against a ray. Twin: src/shadow/cell.rs.
// use: shadow_square

const CELL_ROUNDS: u32 = 6u;

struct CellPatch {
    west: Meridian,
    east: Meridian,
    south: Parallel,
    north: Parallel,
    // South-west, south-east, north-west, north-east.
    corners_m: vec4<f32>,
    base_m: f32,
}

fn cell_patch(ray: Ray, cell: Square, corners_m: vec4<f32>, first: bool) -> CellPatch {
    let shift = square_shift(cell.level);
    var patch_ = CellPatch(
        ray_meridian(ray, cell.x << shift),
        ray_meridian(ray, (cell.x + 1u) << shift),
        ray_parallel(ray, cell.y << shift),
        ray_parallel(ray, (cell.y + 1u) << shift),
        corners_m - ray.height_m,
        0.0,
    );
    if first {
        patch_.base_m = cell_above_m(ray, patch_, 0.0);
    }
    return patch_;
}

fn cell_above_m(ray: Ray, cell: CellPatch, at_m: f32) -> f32 {
    let bend_m = ray_bend_m(ray, at_m);
    let u = cell_share(ray_east_of_m(cell.west, at_m), ray_east_of_m(cell.east, at_m));
    let v = cell_share(ray_north_of_m(cell.south, at_m, bend_m), ray_north_of_m(cell.north, at_m, bend_m));
    let h = cell.corners_m;
    let low = h.x + (h.y - h.x) * u;
    let high = h.z + (h.w - h.z) * u;
    return (low + (high - low) * v - cell.base_m) - ray_rise_m(ray, at_m);
}

fn cell_share(from_m: f32, to_m: f32) -> f32 {
    let width_m = from_m - to_m;
    if width_m > 0.0 {
        return clamp(from_m / width_m, 0.0, 1.0);
    }
    return 0.0;
}

fn cell_slope(ray: Ray, cell: CellPatch, from_m: f32, to_m: f32, best: f32) -> f32 {
    let length_m = to_m - from_m;
    let f0 = cell_above_m(ray, cell, from_m);
    let f1 = cell_above_m(ray, cell, from_m + 0.5 * length_m);
    let f2 = cell_above_m(ray, cell, to_m);
    let p = 4.0 * f1 - 3.0 * f0 - f2;
    let q = 2.0 * (f0 + f2) - 4.0 * f1;
    var slope = max(max(best, f0 / from_m), f2 / to_m);
    for (var i = 0u; i < CELL_ROUNDS; i++) {
        let rise = p - slope * length_m;
        let inside = q < 0.0 && rise > 0.0 && rise < -2.0 * q;
        let x = select(0.0, -0.5 * rise / q, inside);
        let steeper = (f0 + x * (p + x * q)) / (from_m + x * length_m);
        if !inside || steeper <= slope {
            break;
        }
        slope = steeper;
    }
    return slope;
}
