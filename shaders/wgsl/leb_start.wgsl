// The triangles a tessellation starts with. One workgroup. Twin: leb::tessellate.
// use: leb_lists leb_region

@compute @workgroup_size(64)
fn leb_start(@builtin(local_invocation_index) index: u32) {
    let count = start_count(planet.plane != 0u);
    if index < count {
        list_out[index] = start_triangle(planet.plane != 0u, index);
    }
    if index == 0u {
        control.count_in = 0u;
        atomicStore(&control.count_out, count);
        atomicStore(&control.relief, 0u);
        atomicStore(&control.overflow, 0u);
        atomicStore(&control.tested, 0u);
        atomicStore(&control.culled, 0u);
        control.passes = 0u;
        control.horizon = select(0u, 1u, params.horizon != 0u && above_ground());
    }
}
