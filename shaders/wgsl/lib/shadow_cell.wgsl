// The bilinear patch of a cell against a ray. Twin: src/shadow/cell.rs.
// use: shadow_square

const POLAR_ROWS: u32 = 8u;
const POLAR_PARTS: u32 = 8u;
const CELL_ROUNDS: u32 = 6u;

struct CellPatch {
    west: Meridian,
    east: Meridian,
    south: Parallel,
    north: Parallel,
    // South-west, south-east, north-west, north-east.
    corners_m: vec4<f32>,
    base_m: f32,
    parts: u32,
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
        cell_parts(cell),
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

fn cell_parts(cell: Square) -> u32 {
    let from_pole = min(cell.y, (1u << (planet.m - cell.level)) - 1u - cell.y);
    return select(1u, POLAR_PARTS, planet.plane == 0u && from_pole < POLAR_ROWS);
}

fn cell_slope(ray: Ray, cell: CellPatch, from_m: f32, to_m: f32, best: f32) -> f32 {
    let part_m = (to_m - from_m) / f32(cell.parts);
    var slope = best;
    // Distance, and height above the ray, where the part begins.
    var begin = vec2(from_m, cell_above_m(ray, cell, from_m));
    for (var part = 1u; part <= cell.parts; part++) {
        let end_m = select(from_m + f32(part) * part_m, to_m, part == cell.parts);
        let middle = cell_above_m(ray, cell, begin.x + 0.5 * (end_m - begin.x));
        let end = cell_above_m(ray, cell, end_m);
        slope = part_slope(vec2(begin.x, end_m), vec3(begin.y, middle, end), slope);
        begin = vec2(end_m, end);
    }
    return slope;
}

fn part_slope(span_m: vec2<f32>, above_m: vec3<f32>, best: f32) -> f32 {
    let from_m = span_m.x;
    let to_m = span_m.y;
    let length_m = to_m - from_m;
    let f0 = above_m.x;
    let f1 = above_m.y;
    let f2 = above_m.z;
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
