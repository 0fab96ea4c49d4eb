// One ray from the relief to the sun. Twin: src/shadow/exact.rs.
// use: sunlight ray shadow_square shadow_cell shadow_sun shadow_pages

const STEPS_MAX: u32 = 1048576u;

struct Trace {
    slope: f32,
    heights: u32,
    extremes: u32,
    steps: u32,
}

fn shadow_exact(s: u32, t: u32, height_m: f32, level: u32, sun: vec3<f32>, disk_rad: f32) -> Sunlight {
    let ray = ray_from(s, t, height_m, sun);
    let trace = shadow_trace(ray, level, disk_slopes(sun, disk_rad));
    return Sunlight(visible_part(trace.slope, sun, disk_rad), trace.heights, trace.extremes, trace.steps);
}

fn shadow_trace(ray: Ray, level: u32, limits: vec2<f32>) -> Trace {
    let least = limits.x;
    let most = limits.y;
    let top = planet.root_level + 1u;
    let near_m = shadow_near_m(level);
    let high_m = planet.max_m - ray.height_m;
    let end_m = ray_end_m(ray, high_m, least);
    var trace = Trace(least, 0u, 0u, 0u);
    if ray_buried(ray, most) {
        trace.slope = FAR;
        return trace;
    }
    var square = square_first(ray, level);
    var leaf = true;
    var first = true;
    var over_pole = false;
    var at_m = 0.0;
    var rise_m = 0.0;
    // Also false for a square that does not exist.
    while square.level <= top && trace.steps < STEPS_MAX {
        trace.steps += 1u;
        var exit = square_exit(ray, square, at_m, over_pole);
        exit.at_m = max(min(exit.at_m, end_m), at_m);
        let out_rise_m = ray_rise_m(ray, exit.at_m);
        if leaf {
            let page = shadow_cell_page(square.level, square.x, square.y);
            if page == NONE {
                square = square_parent(square);
                leaf = first;
                continue;
            }
            let corners_m = shadow_corners_m(page, square.x, square.y);
            trace.heights += 4u;
            if exit.at_m >= near_m {
                let cell = cell_patch(ray, square, corners_m, first);
                trace.slope = cell_slope(ray, cell, max(at_m, near_m), exit.at_m, trace.slope);
                if trace.slope > most {
                    return trace;
                }
            }
            first = false;
        } else {
            let page = shadow_block_page(square.level - 1u, square.x, square.y);
            if page == NONE {
                leaf = true;
                continue;
            }
            let bounds_m = shadow_extremes_m(page, square.x, square.y) - ray.height_m;
            trace.extremes += 1u;
            if bounds_m.y > ray_lowest_m(ray, vec2(at_m, exit.at_m), vec2(rise_m, out_rise_m), trace.slope) {
                if bounds_m.x > out_rise_m + most * exit.at_m
                    || (bounds_m.x > rise_m + most * at_m && at_m >= near_m) {
                    trace.slope = FAR;
                    return trace;
                }
                square = square_child(ray, square, at_m, over_pole);
                leaf = square.level == level;
                continue;
            }
        }
        if out_rise_m + trace.slope * exit.at_m >= high_m && exit.at_m >= ray_lowest_at_m(ray, trace.slope) {
            break;
        }
        at_m = exit.at_m;
        rise_m = out_rise_m;
        let beside = square_beside(square, exit.dx, exit.dy);
        if beside.level == NONE {
            break;
        }
        over_pole = over_pole || (exit.dy != 0 && beside.y == square.y);
        let inside = beside.x >> 1u == square.x >> 1u && beside.y >> 1u == square.y >> 1u;
        if inside || beside.level == top {
            square = beside;
        } else {
            square = square_parent(beside);
            leaf = false;
        }
    }
    return trace;
}

fn ray_lowest_at_m(ray: Ray, slope: f32) -> f32 {
    return -ray.r0_m * (ray.direction.z + slope);
}

fn ray_lowest_m(ray: Ray, at_m: vec2<f32>, rise_m: vec2<f32>, slope: f32) -> f32 {
    let low_at_m = ray_lowest_at_m(ray, slope);
    if at_m.x >= low_at_m {
        return rise_m.x + slope * at_m.x;
    }
    if at_m.y <= low_at_m {
        return rise_m.y + slope * at_m.y;
    }
    return ray_rise_m(ray, low_at_m) + slope * low_at_m;
}

fn ray_buried(ray: Ray, slope: f32) -> bool {
    let low_at_m = ray_lowest_at_m(ray, slope);
    if planet.plane != 0u || low_at_m <= 0.0 {
        return false;
    }
    let at_m = min(low_at_m, 0.5 * ray.r0_m);
    return ray_rise_m(ray, at_m) + slope * at_m < planet.min_m - ray.height_m;
}

fn ray_end_m(ray: Ray, high_m: f32, slope: f32) -> f32 {
    let up = ray.direction.z + slope;
    let climb_m = 1.05 * max(high_m, 0.0) + 1.0;
    if planet.plane != 0u {
        return ray_line_at_m(climb_m, up);
    }
    let fall_m = -ray.r0_m * up;
    let root_m = sqrt(fall_m * fall_m + (2.0 * ray.r0_m + climb_m) * climb_m);
    var near_m = fall_m + root_m;
    if up > 0.0 {
        near_m = (2.0 * ray.r0_m + climb_m) * climb_m / (root_m - fall_m);
    }
    return (1.1 + abs(planet.e2)) * near_m;
}
