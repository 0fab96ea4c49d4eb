// Shades the pixels that `frame_draw` stored. Twin: src/frame/shade.rs, shade_pixel.
// use: shade shade_ground

@group(1) @binding(0) var<uniform> view: View;
@group(1) @binding(2) var places: texture_2d<u32>;
@group(1) @binding(3) var depths: texture_depth_2d;
// Red, green, blue, and the visible part of the sun's disk.
@group(1) @binding(4) var<storage, read_write> colours: array<u32>;
// Metres from the camera; 0 in the sky.
@group(1) @binding(5) var<storage, read_write> distances: array<f32>;
// East and north of the ground's unit normal.
@group(1) @binding(6) var<storage, read_write> normals: array<u32>;

@compute @workgroup_size(8, 8)
fn shade_pixels(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixel = id.y * view.width + id.x;
    let x = ((f32(id.x) + 0.5) * 2.0 / f32(view.width) - 1.0) * view.tan_x;
    let y = (1.0 - (f32(id.y) + 0.5) * 2.0 / f32(view.height)) * view.tan_y;
    let stretch = sqrt(1.0 + x * x + y * y);
    let depth = textureLoad(depths, id.xy, 0);
    if depth == 0.0 {
        let ray = (view.forward.xyz + view.right.xyz * x + view.up.xyz * y) / stretch;
        colours[pixel] = pack4x8unorm(vec4(to_srgb(sky_colour(view, ray)), 0.0));
        distances[pixel] = 0.0;
        normals[pixel] = 0u;
        return;
    }
    let distance_m = view.forward.w / depth * stretch;
    let place = textureLoad(places, id.xy, 0);
    let level = detail(view, distance_m);
    let here = ground_between(level, place.x, place.y, metres_per_unit(place.y));
    let axes = horizon_axes(view, place.x, place.y);
    let sun = vec3(dot(axes[0], view.sun.xyz), dot(axes[1], view.sun.xyz), dot(axes[2], view.sun.xyz));
    let visible = 1.0;
    let slope = vec2(here.east, here.north);
    let steep = slope * exaggeration(distance_m / view.right.w);
    var colour = ground_colour(here.height_m, steep, sun, visible);
    if style.overlay == DETAIL {
        colour = mix(colour, detail_colour(i32(place.z & 255u) - 128), 0.45);
    }
    if style.overlay != NO_OVERLAY {
        let edge = f32((place.z >> 8u) & 255u) / 32.0;
        colour = mix(vec3(0.01, 0.012, 0.02), colour, 0.25 + 0.75 * smoothstep(0.2, 0.8, edge));
    }
    colours[pixel] = pack4x8unorm(vec4(to_srgb(colour), visible));
    distances[pixel] = distance_m;
    normals[pixel] = pack2x16snorm(normalize(vec3(-slope, 1.0)).xy);
}
