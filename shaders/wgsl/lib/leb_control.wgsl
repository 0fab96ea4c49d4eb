// The counts that steer the passes. Twin: src/leb/tessellate.rs.

struct LebControl {
    // Triangles of the list that is read.
    count_in: u32,
    // Triangles asked to be put in the list that is written.
    count_out: atomic<u32>,
    // Relief triangles asked to be drawn.
    relief: atomic<u32>,
    // 1 when a list was full.
    overflow: atomic<u32>,
    tested: atomic<u32>,
    culled: atomic<u32>,
    passes: u32,
    // 1 when the horizon hides.
    horizon: u32,
}
