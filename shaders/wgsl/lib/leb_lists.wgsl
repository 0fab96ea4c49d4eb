// Lists of triangles. Twin: src/leb/tessellate.rs.
// use: leb_triangle leb_control leb_corner

@group(1) @binding(2) var<storage, read> list_in: array<Triangle>;
@group(1) @binding(3) var<storage, read_write> list_out: array<Triangle>;
@group(1) @binding(4) var<storage, read_write> relief: array<ReliefTriangle>;
@group(1) @binding(5) var<storage, read_write> control: LebControl;
