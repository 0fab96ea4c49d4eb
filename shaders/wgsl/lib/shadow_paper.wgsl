// The shadow kernel of paper 001 on a plane, Algo 2 and 3. Twin: src/shadow/paper.rs.
//
// The kernel that uses this binds paper_map: ShadowPaperMap, paper_heights_m (H_0 to H_m) and
// paper_extremes (H_ext of levels 0 to m - 2), finest first, rows from the south.
// use: sunlight

struct ShadowPaperMap {
    // Unit vector to the sun: east, north, up.
    sun: vec4<f32>,
    spacing_m: vec2<f32>,
    // 2^m x 2^m texels.
    m: u32,
    // Level of detail.
    q: u32,
    // 0: the greatest height is compared at the exit, as printed; 1: at the entry.
    reading: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

const PAPER_EPSILON: f32 = 1.0e-7;
const PAPER_STEPS_MAX: u32 = 65536u;

struct PaperCrossing {
    distance_m: f32,
    column: i32,
    row: i32,
}

fn paper_level_start(m: u32, level: u32) -> u32 {
    // The sum of a geometric series: no 4^(m+1), which overflows at m = 15.
    var start = 0u;
    for (var k = 0u; k < level; k++) {
        start += 1u << (2u * (m - k));
    }
    return start;
}

fn paper_height_m(level: u32, column: i32, row: i32) -> f32 {
    let side = 1 << (paper_map.m - level);
    let i = clamp(column, 0, side - 1);
    let j = clamp(row, 0, side - 1);
    return paper_heights_m[i32(paper_level_start(paper_map.m, level)) + j * side + i];
}

fn paper_bilinear_m(level: u32, x: f32, y: f32) -> f32 {
    let scale = 1.0 / f32(1u << level);
    let px = x * scale - 0.5;
    let py = y * scale - 0.5;
    let i = floor(px);
    let j = floor(py);
    let u = px - i;
    let v = py - j;
    let h00 = paper_height_m(level, i32(i), i32(j));
    let h10 = paper_height_m(level, i32(i) + 1, i32(j));
    let h01 = paper_height_m(level, i32(i), i32(j) + 1);
    let h11 = paper_height_m(level, i32(i) + 1, i32(j) + 1);
    let low = h00 + (h10 - h00) * u;
    let high = h01 + (h11 - h01) * u;
    return low + (high - low) * v;
}

fn paper_extremes_m(level: u32, column: i32, row: i32) -> vec2<f32> {
    let side = 1 << (paper_map.m - 1u - level);
    return paper_extremes[i32(paper_level_start(paper_map.m - 1u, level)) + row * side + column];
}

fn paper_shadow(at: vec2<f32>, height_m: f32, q: u32, sun: vec3<f32>) -> Sunlight {
    var light = Sunlight(1.0, 0u, 0u, 0u);
    let flat = sqrt(sun.x * sun.x + sun.y * sun.y);
    let step = sun.xy / (max(flat, PAPER_EPSILON) * paper_map.spacing_m);
    if flat <= PAPER_EPSILON || (abs(step.x) <= PAPER_EPSILON && abs(step.y) <= PAPER_EPSILON) {
        return light;
    }
    let climb = sun.z / flat;
    let coarsest = paper_map.m - 1u;
    let side = 1 << (paper_map.m - q);
    let scale = 1.0 / f32(1u << q);
    let first = paper_crossing(at, step, q, vec2<i32>(floor(at * scale)), 0.0);
    var distance_m = first.distance_m;
    var texel = vec2(first.column, first.row);
    var level = q;
    while all(texel >= vec2(0)) && all(texel < vec2(side)) && light.steps < PAPER_STEPS_MAX {
        light.steps += 1u;
        let shift = level - q;
        let here = texel >> vec2(shift);
        let out = paper_crossing(at, step, level, here, distance_m);
        let ray_m = height_m + climb * out.distance_m;
        var below = false;
        if level > q {
            let bounds_m = paper_extremes_m(level - 1u, here.x, here.y);
            light.extremes += 1u;
            if ray_m <= bounds_m.x {
                light.visible = 0.0;
                return light;
            }
            let test_m = select(out.distance_m, distance_m, paper_map.reading == 1u);
            below = height_m + climb * test_m <= bounds_m.y;
        } else {
            let middle_m = 0.5 * (distance_m + out.distance_m);
            let middle = at + step * middle_m;
            light.heights += 4u;
            if height_m + climb * middle_m <= paper_bilinear_m(q, middle.x, middle.y) {
                light.visible = 0.0;
                return light;
            }
        }
        if below {
            level -= 1u;
            continue;
        }
        let end = (at + step * out.distance_m) * scale;
        texel = vec2(
            paper_texel(end.x, here.x, out.column, shift),
            paper_texel(end.y, here.y, out.row, shift),
        );
        distance_m = out.distance_m;
        level = coarsest;
    }
    return light;
}

fn paper_crossing(at: vec2<f32>, step: vec2<f32>, level: u32, texel: vec2<i32>, from_m: f32) -> PaperCrossing {
    let size = f32(1u << level);
    let ahead = step >= vec2(0.0);
    let corner = vec2<f32>(texel + vec2<i32>(ahead)) * size;
    let d = select(vec2(-1), vec2(1), ahead);
    if abs(step.x) <= PAPER_EPSILON {
        return PaperCrossing(max((corner.y - at.y) / step.y, from_m), texel.x, texel.y + d.y);
    }
    if abs(step.y) <= PAPER_EPSILON {
        return PaperCrossing(max((corner.x - at.x) / step.x, from_m), texel.x + d.x, texel.y);
    }
    let e = (corner - at) / step;
    return PaperCrossing(
        max(min(e.x, e.y), from_m),
        select(texel.x, texel.x + d.x, e.x <= e.y),
        select(texel.y, texel.y + d.y, e.y <= e.x),
    );
}

fn paper_texel(place: f32, here: i32, next: i32, shift: u32) -> i32 {
    if next > here {
        return next << shift;
    }
    if next < here {
        return ((next + 1) << shift) - 1;
    }
    return clamp(i32(floor(place)), here << shift, ((here + 1) << shift) - 1);
}
