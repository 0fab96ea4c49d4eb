// Height and sunlight of points. Twin: src/shadow/points.rs, shadow_points.
// use: shadow

struct PointSun {
    sun: vec4<f32>,
    level: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct SunlitPoint {
    s: u32,
    t: u32,
    height_m: f32,
    visible: f32,
}

@group(1) @binding(0) var<uniform> point_sun: PointSun;
@group(1) @binding(1) var<storage, read_write> points: array<SunlitPoint>;

@compute @workgroup_size(64)
fn shadow_points(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&points) {
        return;
    }
    let s = points[id.x].s;
    let t = points[id.x].t;
    let level = point_sun.level;
    let here_m = height_m(level, s, t);
    var sun = point_sun.sun.xyz;
    if planet.plane == 0u {
        sun = sun_local(sun, 0x80000000u, s, t);
    }
    points[id.x].height_m = here_m;
    points[id.x].visible = shadow_exact(s, t, here_m, level, sun, point_sun.sun.w).visible;
}
