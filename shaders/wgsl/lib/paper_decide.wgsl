// Whether a patch is split: Algorithm 3 of paper 000. Twin: src/paper/decide.rs.
// use: angle pages position leb_view leb_active paper_patch paper_extent

struct Prism {
    above_m: f32,
    below_m: f32,
}

fn splits(p: Patch) -> bool {
    if patch_level(p) < 0 {
        return false;
    }
    let level = u32(patch_level(p));
    let stored = level <= planet.root_level;
    let o = patch_midpoint(p, 1u);
    var is_usable = true;
    var deviation = 0.0;
    if stored {
        let at = tile_place(level, o.x, o.y);
        let page = find_page(level, at.x, at.y);
        is_usable = page != NONE && (page & USABLE) != 0u;
        if is_usable {
            deviation = deviation_m(page & SLOT_MASK, at.column, at.row);
        } else {
            // S_0 and the patch lie in the same interval.
            let range = square_interval_m(p);
            deviation = range.y - range.x;
        }
    } else {
        deviation = crown_m(o);
    }
    let seen_large = shows(p, deviation);
    if stored && (is_usable || seen_large) {
        let at = tile_place(level, o.x, o.y);
        ask_page(level, at.x, at.y);
    }
    return is_usable && seen_large;
}

fn crown_m(o: vec2<u32>) -> f32 {
    let at = tile_place(planet.root_level, o.x, o.y);
    let page = find_page(planet.root_level, at.x, at.y);
    if page == NONE {
        return params.range_m;
    }
    let deviation = deviation_m(page & SLOT_MASK, at.column, at.row);
    return select(params.range_m, min(deviation, params.range_m), deviation > 0.0);
}

fn shows(p: Patch, deviation: f32) -> bool {
    var corners: array<vec3<f32>, 3>;
    for (var k = 0u; k < 3u; k++) {
        let at = patch_corner(p, k);
        corners[k] = camera_relative_m(view, at.x, at.y, corner_height_m(at));
    }
    let prism = Prism(deviation + bulge_m(corners[1], corners[2]), deviation);
    if prism.above_m <= 0.0 {
        return false;
    }
    let o = patch_midpoint(p, 1u);
    let middle = camera_relative_m(view, o.x, o.y, corner_height_m(o));
    var radius2 = 0.0;
    let distance2 = dot3(middle, middle);
    for (var k = 0u; k < 3u; k++) {
        let d = corners[k] - middle;
        radius2 = max(radius2, dot3(d, d));
    }
    if distance2 < 4.0 * radius2 && shows_near(prism, sqrt(distance2) - sqrt(radius2)) {
        return true;
    }
    var large = false;
    for (var k = 0u; k < 3u; k++) {
        let up = normal_at(patch_corner(p, k));
        large = large || shows_at(prism, corners[k], up);
    }
    return large;
}

fn corner_height_m(at: vec2<u32>) -> f32 {
    return height_m(corner_level(at), at.x, at.y);
}

fn corner_level(at: vec2<u32>) -> u32 {
    return min(min(countTrailingZeros(at.x | at.y), 31u) - (31u - planet.m), planet.root_level);
}

fn bulge_m(a: vec3<f32>, b: vec3<f32>) -> f32 {
    if planet.plane != 0u {
        return 0.0;
    }
    let least = min(planet.a_m * (planet.a_m / planet.b_m), planet.b_m * (planet.b_m / planet.a_m));
    let radius = max(least + planet.min_m, 0.01 * least);
    let chord = b - a;
    return dot3(chord, chord) / (8.0 * radius);
}

fn normal_at(at: vec2<u32>) -> vec3<f32> {
    if planet.plane != 0u {
        return vec3(0.0, 0.0, 1.0);
    }
    let lon = sin_cos(at.x - view.camera_s);
    let lat = sin_cos_lat(at.y);
    return vec3(lat.y * lon.y, lat.y * lon.x, lat.x);
}

fn shows_at(prism: Prism, corner: vec3<f32>, up: vec3<f32>) -> bool {
    let c = along_axes(corner);
    let n = along_axes(up);
    let distance = sqrt(dot3(corner, corner));
    let z_above = c.z + prism.above_m * n.z;
    let z_below = c.z - prism.below_m * n.z;
    // Further off the axis than anything in view, or behind the camera: as at the view's corner.
    if min(z_above, z_below) < 0.5 * params.cos_corner * distance {
        return shows_near(prism, distance - max(prism.above_m, prism.below_m));
    }
    let scale = (prism.above_m + prism.below_m) / (z_above * z_below);
    let rx = scale * (n.x * c.z - n.z * c.x) / view.tan_x;
    let ry = scale * (n.y * c.z - n.z * c.y) / view.tan_y;
    return rx * rx + ry * ry > threshold2();
}

fn shows_near(prism: Prism, distance_m: f32) -> bool {
    let cosine = params.cos_corner;
    let r = (prism.above_m + prism.below_m) / (cosine * cosine * min(view.tan_x, view.tan_y));
    return distance_m <= 0.0 || r * r > threshold2() * (distance_m * distance_m);
}

// (n_px max(2/w, 2/h))^2.
fn threshold2() -> f32 {
    let n = view.up.w * max(2.0 / f32(view.width), 2.0 / f32(view.height));
    return n * n;
}

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
