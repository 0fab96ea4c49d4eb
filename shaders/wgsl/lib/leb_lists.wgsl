// Lists of triangles, and the counts that steer the passes. Twin: src/leb/tessellate.rs.
// use: leb_triangle leb_corner

struct ReliefTriangle {
    corners: array<Corner, 3>,
}

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

@group(1) @binding(2) var<storage, read> list_in: array<Triangle>;
@group(1) @binding(3) var<storage, read_write> list_out: array<Triangle>;
@group(1) @binding(4) var<storage, read_write> relief: array<ReliefTriangle>;
@group(1) @binding(5) var<storage, read_write> control: LebControl;
