// The mesh without adaptation: two triangles for each cell of a level. Twin: src/frame/uniform.rs.
// use: pages leb_corner

struct UniformMesh {
    level: u32,
    columns: u32,
    rows: u32,
    padding: u32,
}

struct TwoTriangles {
    corners: array<Corner, 6>,
}

@group(1) @binding(0) var<uniform> mesh: UniformMesh;
@group(1) @binding(1) var<storage, read_write> cells: array<TwoTriangles>;

fn uniform_corner(i: u32, j: u32) -> Corner {
    let shift = 31u - planet.m + mesh.level;
    let s = i << shift;
    let t = j << shift;
    return Corner(s, t, height_m(mesh.level, s, t), i32(mesh.level));
}

@compute @workgroup_size(8, 8)
fn frame_uniform(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= mesh.columns || id.y >= mesh.rows {
        return;
    }
    let sw = uniform_corner(id.x, id.y);
    let se = uniform_corner(id.x + 1u, id.y);
    let nw = uniform_corner(id.x, id.y + 1u);
    let ne = uniform_corner(id.x + 1u, id.y + 1u);
    cells[id.y * mesh.columns + id.x] = TwoTriangles(array(sw, se, nw, ne, nw, se));
}
