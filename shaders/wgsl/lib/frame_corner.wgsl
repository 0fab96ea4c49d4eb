// A corner of a relief triangle. Twin: src/frame/mod.rs.

struct Corner {
    s: u32,
    t: u32,
    height_m: f32,
    level: i32,
}
