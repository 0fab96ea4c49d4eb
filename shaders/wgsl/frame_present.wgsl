// Copies a shaded picture into the host's colour and depth targets.
// use: planet

@group(0) @binding(1) var<uniform> view: View;
@group(0) @binding(2) var<storage, read> colours: array<u32>;
@group(0) @binding(3) var<storage, read> distances: array<f32>;

struct Presented {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn pixel_of(position: vec4<f32>) -> u32 {
    return u32(position.y) * view.width + u32(position.x);
}

fn to_linear(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

// For targets that store what they are given.
@fragment
fn present(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4(unpack4x8unorm(colours[pixel_of(position)]).xyz, 1.0);
}

// For targets that encode sRGB themselves.
@fragment
fn present_linear(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4(to_linear(unpack4x8unorm(colours[pixel_of(position)]).xyz), 1.0);
}
