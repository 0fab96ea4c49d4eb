// Copies a shaded picture into the host's colour and depth targets.
// use: planet

@group(0) @binding(1) var<uniform> view: View;
@group(0) @binding(2) var<storage, read> colours: array<u32>;
@group(0) @binding(3) var<storage, read> distances: array<f32>;

// True for targets that encode sRGB themselves.
override linear: bool = false;

struct Presented {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn colour_of(pixel: u32) -> vec4<f32> {
    let c = unpack4x8unorm(colours[pixel]).xyz;
    let light = select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
    return vec4(select(c, light, linear), 1.0);
}

fn pixel_of(position: vec4<f32>) -> u32 {
    return u32(position.y) * view.width + u32(position.x);
}

@fragment
fn present(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return colour_of(pixel_of(position));
}

// Depth: distance of the near plane over that along the axis of sight; 0 in the sky.
@fragment
fn present_depth(@builtin(position) position: vec4<f32>) -> Presented {
    let pixel = pixel_of(position);
    let x = (position.x * 2.0 / f32(view.width) - 1.0) * view.tan_x;
    let y = (1.0 - position.y * 2.0 / f32(view.height)) * view.tan_y;
    let distance_m = distances[pixel];
    let depth = view.forward.w * sqrt(1.0 + x * x + y * y) / max(distance_m, 1e-30);
    return Presented(colour_of(pixel), select(depth, 0.0, distance_m == 0.0));
}
