// A corner of a relief triangle. Twin: src/leb/tessellate.rs.

struct Corner {
    s: u32,
    t: u32,
    height_m: f32,
    level: i32,
}
