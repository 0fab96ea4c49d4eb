// What every kernel is told of the planet and of the view. Twins: src/planet.rs.

struct Planet {
    m: u32,
    plane: u32,
    root_level: u32,
    table_bits: u32,
    a_m: f32,
    b_m: f32,
    e2: f32,
    step_m: f32,
    min_m: f32,
    max_m: f32,
    unit_x_m: f32,
    unit_y_m: f32,
    seen_bits: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct View {
    camera_s: u32,
    camera_t: u32,
    width: u32,
    height: u32,
    camera_h_hi_m: f32,
    camera_h_lo_m: f32,
    sin_lat: f32,
    cos_lat: f32,
    n0_m: f32,
    w0: f32,
    tan_x: f32,
    tan_y: f32,
    right: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    sun: vec4<f32>,
}

@group(0) @binding(0) var<uniform> planet: Planet;
