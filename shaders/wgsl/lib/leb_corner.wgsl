// What tessellations yield. Twin: src/leb/tessellate.rs.

struct Corner {
    s: u32,
    t: u32,
    height_m: f32,
    level: i32,
}

struct ReliefTriangle {
    corners: array<Corner, 3>,
}
