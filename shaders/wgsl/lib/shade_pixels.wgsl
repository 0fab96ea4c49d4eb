// Shades the pixels that `frame_draw` stored. Twin: src/frame/shade.rs. The kernel that uses this
// says what `pixel_light` is.
// use: shade_light shade_ground shade_overlay shadow_sun sunlight sea

@group(1) @binding(0) var<uniform> view: View;
@group(1) @binding(2) var places: texture_2d<u32>;
@group(1) @binding(3) var depths: texture_depth_2d;
// Red, green, blue, and the visible part of the sun's disk.
@group(1) @binding(4) var<storage, read_write> colours: array<u32>;
// Metres from the camera; 0 in the sky.
@group(1) @binding(5) var<storage, read_write> distances: array<f32>;
// East and north of the ground's unit normal.
@group(1) @binding(6) var<storage, read_write> normals: array<u32>;
// Rays, heights, extremes and steps; zeroed before.
@group(1) @binding(7) var<storage, read_write> fetched: array<atomic<u32>, 4>;

// The grid of sea levels, read where the style says so.
@group(1) @binding(8) var<uniform> sea_m: array<vec4<f32>, 4095>;

// False where a picture has no overlay: code that is never run takes registers all the same.
override overlaid: bool = true;

var<workgroup> group_fetched: array<atomic<u32>, 4>;

struct Spot {
    pixel: vec2<u32>,
    place: vec4<u32>,
    point_m: vec3<f32>,
    distance_m: f32,
}

struct Shaded {
    colour: u32,
    distance_m: f32,
    normal: u32,
}

fn shade_sky(ray: vec3<f32>) -> Shaded {
    return Shaded(pack4x8unorm(vec4(to_srgb(sky_colour(view, ray)), 0.0)), 0.0, 0u);
}

fn sunlight(here: Ground, s: u32, t: u32, sun: vec3<f32>) -> f32 {
    if style.shadow == NO_SHADOW {
        return 1.0;
    }
    let light = pixel_light(here, s, t, sun);
    atomicAdd(&group_fetched[0], 1u);
    atomicAdd(&group_fetched[1], light.heights);
    atomicAdd(&group_fetched[2], light.extremes);
    atomicAdd(&group_fetched[3], light.steps);
    return light.visible;
}

fn sun_at(s: u32, t: u32) -> vec3<f32> {
    var sun = view.sun.xyz;
    if planet.plane == 0u {
        sun = sun_local(view.sun.xyz, view.camera_s, s, t);
    }
    if style.air > 0.0 {
        sun = refracted(sun, style.air);
    }
    return sun;
}

// A pixel's line of sight: right and up where it is 1 along the axis, and its length there.
fn sight(pixel: vec2<u32>) -> vec3<f32> {
    let x = ((f32(pixel.x) + 0.5) * 2.0 / f32(view.width) - 1.0) * view.tan_x;
    let y = (1.0 - (f32(pixel.y) + 0.5) * 2.0 / f32(view.height)) * view.tan_y;
    return vec3(x, y, sqrt(1.0 + x * x + y * y));
}

// The page that a pixel's height is from; none in the sky and beyond the picture.
fn page_at(pixel: vec2<u32>) -> u32 {
    if pixel.x >= view.width || pixel.y >= view.height {
        return NONE;
    }
    let depth = textureLoad(depths, pixel, 0);
    if depth == 0.0 {
        return NONE;
    }
    let place = textureLoad(places, pixel, 0);
    let wanted = u32(detail(view, view.forward.w / depth * sight(pixel).z));
    let level = finest_level(wanted, place.x, place.y);
    let at = tile_place(level, place.x, place.y);
    return page_key(level, at.x, at.y);
}

fn over_pages(spot: Spot, wanted: u32, level: u32) -> vec3<f32> {
    let at = tile_place(level, spot.place.x, spot.place.y);
    var colour = page_colour(level, at.x, at.y);
    if level > wanted {
        colour = striped(colour, spot.pixel);
    }
    let here = page_key(level, at.x, at.y);
    let beside = vec4(
        page_at(spot.pixel + vec2(1u, 0u)),
        page_at(spot.pixel - vec2(1u, 0u)),
        page_at(spot.pixel + vec2(0u, 1u)),
        page_at(spot.pixel - vec2(0u, 1u)),
    );
    if any((beside != vec4(here)) & (beside != vec4(NONE))) {
        colour *= 0.1;
    }
    return colour;
}

fn over_error(spot: Spot) -> vec3<f32> {
    let error = drawn_error(view, spot.place.x, spot.place.y, spot.point_m, spot.distance_m);
    let colour = error_colour(error.px / view.up.w);
    if error.level > 0u {
        return striped(colour, spot.pixel);
    }
    return colour;
}

fn over(spot: Spot, colour: vec3<f32>, wanted: u32, level: u32, light: vec3<f32>, sun: vec3<f32>) -> vec3<f32> {
    if style.overlay == PAGES {
        let level_light = ground_light(vec2(0.0, 0.0), sun, 1.0);
        return in_relief(over_pages(spot, wanted, level), light, level_light, 0.9);
    }
    if style.overlay == ERROR {
        let level_light = ground_light(vec2(0.0, 0.0), sun, 1.0);
        return in_relief(over_error(spot), light, level_light, 0.5);
    }
    var marked = colour;
    if style.overlay == DETAIL {
        marked = mix(colour, detail_colour(i32(spot.place.z & 255u) - 128), 0.45);
    }
    let edge = f32((spot.place.z >> 8u) & 255u) / 32.0;
    return mix(vec3(0.01, 0.012, 0.02), marked, 0.25 + 0.75 * smoothstep(0.2, 0.8, edge));
}

fn shade_ground(spot: Spot) -> Shaded {
    let place = spot.place;
    let distance_m = spot.distance_m;
    let level = detail(view, distance_m);
    let here = ground_between(level, place.x, place.y, metres_per_unit(place.y));
    let sun = sun_at(place.x, place.y);
    let visible = sunlight(here, place.x, place.y, sun);
    let slope = vec2(here.east, here.north);
    let steep = slope * exaggeration(distance_m / view.right.w);
    var sea = 0.0;
    if style.sea == SEA_GRID {
        sea = sea_level_m(place.x, place.y);
    }
    let light = ground_light(steep, sun, visible);
    var colour = tint(here.height_m - sea) * light;
    if overlaid && style.overlay != NO_OVERLAY {
        colour = over(spot, colour, u32(level), here.level, light, sun);
    }
    let normal = normalize(vec3(-slope, 1.0));
    return Shaded(pack4x8unorm(vec4(to_srgb(colour), visible)), distance_m, pack2x16snorm(normal.xy));
}

@compute @workgroup_size(8, 8)
fn shade_pixels(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    if id.x < view.width && id.y < view.height {
        let sight = sight(id.xy);
        let along = view.forward.xyz + view.right.xyz * sight.x + view.up.xyz * sight.y;
        let depth = textureLoad(depths, id.xy, 0);
        var shaded: Shaded;
        if depth == 0.0 {
            shaded = shade_sky(along / sight.z);
        } else {
            let axial_m = view.forward.w / depth;
            let place = textureLoad(places, id.xy, 0);
            shaded = shade_ground(Spot(id.xy, place, along * axial_m, axial_m * sight.z));
        }
        let pixel = id.y * view.width + id.x;
        colours[pixel] = shaded.colour;
        distances[pixel] = shaded.distance_m;
        normals[pixel] = shaded.normal;
    }
    workgroupBarrier();
    if local < 4u {
        atomicAdd(&fetched[local], atomicLoad(&group_fetched[local]));
    }
}
