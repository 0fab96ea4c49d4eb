// Heights at points. Twin: src/pages.rs, Pages::height_m.
// use: pages

struct Point {
    s: u32,
    t: u32,
    level: u32,
    height_m: f32,
}

@group(1) @binding(0) var<storage, read_write> points: array<Point>;

@compute @workgroup_size(64)
fn heights_at(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&points) {
        return;
    }
    let p = points[id.x];
    points[id.x].height_m = height_m(p.level, p.s, p.t);
}
