// The sunlight of the nodes of a window. Twin: src/shadow/mask.rs, shadow_mask.
//
// group(0): the pages. group(1): 0 the window; 1 the mask, a byte a node, south row first, zeroed
// before; 2 the sums of heights, extremes and steps fetched, zeroed before.
// use: shadow

struct ShadowWindow {
    sun: vec4<f32>,
    x: u32,
    y: u32,
    columns: u32,
    rows: u32,
    level: u32,
    air: f32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> window: ShadowWindow;
@group(1) @binding(1) var<storage, read_write> mask: array<atomic<u32>>;
@group(1) @binding(2) var<storage, read_write> fetched: array<atomic<u32>, 3>;

fn sun_of_window(s: u32, t: u32) -> vec3<f32> {
    var local = window.sun.xyz;
    if planet.plane == 0u {
        local = sun_local(window.sun.xyz, 0x80000000u, s, t);
    }
    if window.air == 0.0 {
        return local;
    }
    return refracted(local, window.air);
}

@compute @workgroup_size(8, 8)
fn shadow_mask(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= window.columns || id.y >= window.rows {
        return;
    }
    let shift = square_shift(window.level);
    let s = (window.x + id.x) << shift;
    let t = (window.y + id.y) << shift;
    let light = shadow_exact(s, t, height_m(window.level, s, t), window.level, sun_of_window(s, t), window.sun.w);
    let node = id.y * window.columns + id.x;
    atomicOr(&mask[node / 4u], u32(light.visible * 255.0 + 0.5) << (8u * (node % 4u)));
    atomicAdd(&fetched[0], light.heights);
    atomicAdd(&fetched[1], light.extremes);
    atomicAdd(&fetched[2], light.steps);
}
