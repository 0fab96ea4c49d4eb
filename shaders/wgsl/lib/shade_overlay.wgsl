// Overlays of pages and of the drawn error. Twin: src/frame/overlay.rs.
// use: shade_ground position

const PAGE_COLOURS = array<vec3<f32>, 7>(
    vec3(0.03, 0.36, 0.78),
    vec3(0.791, 0.347, 0.0),
    vec3(0.0, 0.342, 0.171),
    vec3(0.604, 0.191, 0.386),
    vec3(0.871, 0.776, 0.054),
    vec3(0.0, 0.168, 0.445),
    vec3(0.665, 0.112, 0.0),
);
const ERROR_COLOURS = array<vec3<f32>, 5>(
    vec3(0.012, 0.062, 0.33),
    vec3(0.2, 0.46, 0.8),
    vec3(0.93, 0.93, 0.93),
    vec3(0.87, 0.26, 0.11),
    vec3(0.32, 0.002, 0.012),
);
const STRIPE: vec3<f32> = vec3(0.03, 0.03, 0.035);

struct DrawnError {
    px: f32,
    level: u32,
}

fn page_colour(level: u32, x: u32, y: u32) -> vec3<f32> {
    let bright = 1.0 - 0.4 * f32((x + y) & 1u);
    let pale = 0.08 * f32(y & 1u);
    return mix(PAGE_COLOURS[level % 7u], vec3(1.0), pale) * bright;
}

fn error_colour(share: f32) -> vec3<f32> {
    let at = clamp(share * 2.0, 0.0, 4.0);
    let k = min(u32(at), 3u);
    return mix(ERROR_COLOURS[k], ERROR_COLOURS[k + 1u], at - f32(k));
}

fn striped(colour: vec3<f32>, pixel: vec2<u32>) -> vec3<f32> {
    return select(colour, mix(colour, STRIPE, 0.72), (pixel.x + pixel.y) % 12u < 4u);
}

fn brightness(light: vec3<f32>) -> f32 {
    return 0.2126 * light.x + 0.7152 * light.y + 0.0722 * light.z;
}

fn in_relief(colour: vec3<f32>, light: vec3<f32>, level_light: vec3<f32>, share: f32) -> vec3<f32> {
    let relief = clamp(brightness(light) / max(brightness(level_light), 1e-4), 0.1, 1.9);
    return colour * (1.0 + share * (relief - 1.0));
}

fn up_at(view: View, s: u32, t: u32) -> vec3<f32> {
    if planet.plane != 0u {
        return vec3(0.0, 0.0, 1.0);
    }
    let lon = sin_cos(s - view.camera_s);
    let lat = sin_cos_lat(t);
    return vec3(lat.y * lon.y, lat.y * lon.x, lat.x);
}

fn drawn_error(view: View, s: u32, t: u32, point_m: vec3<f32>, distance_m: f32) -> DrawnError {
    let asked = max(u32(detail(view, distance_m)), 1u) - 1u;
    let first = tile_place(asked, s, t);
    ask_page(asked, first.x, first.y);
    let level = finest_page(0u, s, t);
    let at = tile_place(level, s, t);
    let page = find_page(level, at.x, at.y);
    let true_m = bilinear_m(page & SLOT_MASK, level, at, s, t);
    let above_m = dot(point_m - camera_relative_m(view, s, t, true_m), up_at(view, s, t));
    return DrawnError(abs(above_m) * view.right.w / distance_m, level);
}
