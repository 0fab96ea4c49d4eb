// Draws relief triangles: fixed-point place, level and edge distance of each pixel.
// Twin: src/frame/raster.rs. Vertices are pulled: three corners a triangle.
// use: position leb_corner

struct Drawn {
    @builtin(position) position: vec4<f32>,
    @location(0) offset: vec2<f32>,
    @location(1) @interpolate(linear) barycentric: vec3<f32>,
    @location(2) @interpolate(flat) base: vec2<u32>,
    @location(3) @interpolate(flat) level: i32,
}

@group(1) @binding(0) var<uniform> view: View;
@group(1) @binding(1) var<storage, read> corners: array<Corner>;

@vertex
fn place_corner(@builtin(vertex_index) index: u32) -> Drawn {
    let first = index - index % 3u;
    let base = corners[first];
    let here = corners[index];
    let p = camera_relative_m(view, here.s, here.t, here.height_m);
    var out: Drawn;
    out.position = vec4(
        dot(view.right.xyz, p) / view.tan_x,
        dot(view.up.xyz, p) / view.tan_y,
        view.forward.w,
        dot(view.forward.xyz, p),
    );
    out.offset = vec2(f32(bitcast<i32>(here.s - base.s)), f32(bitcast<i32>(here.t - base.t)));
    out.barycentric = vec3<f32>(vec3(index % 3u) == vec3(0u, 1u, 2u));
    out.base = vec2(base.s, base.t);
    out.level = min(base.level, min(corners[first + 1u].level, corners[first + 2u].level));
    return out;
}

// A fixed-point coordinate some units on: a longitude wraps, others stay between the map's edges.
fn shifted(base: u32, units: f32, wraps: bool) -> u32 {
    let away = u32(round(abs(units)));
    if wraps {
        return select(base + away, base - away, units < 0.0);
    }
    return select(min(base + away, 0x80000000u), base - min(away, base), units < 0.0);
}

// S, T, then the level plus 128 in bits 0 to 7 and the edge distance in 32nds of a pixel in bits 8
// to 15.
@fragment
fn store_place(in: Drawn) -> @location(0) vec4<u32> {
    let s = shifted(in.base.x, in.offset.x, planet.plane == 0u);
    let t = shifted(in.base.y, in.offset.y, false);
    let slope = sqrt(dpdx(in.barycentric) * dpdx(in.barycentric) + dpdy(in.barycentric) * dpdy(in.barycentric));
    let distances = in.barycentric / max(slope, vec3(1e-12));
    let edge = clamp(min(distances.x, min(distances.y, distances.z)) * 32.0, 0.0, 255.0);
    return vec4(s, t, u32(in.level + 128) | (u32(edge) << 8u), 0u);
}
