// The patches a tessellation starts with: those of the patch mesh that may be seen. One invocation
// each. Twin: paper::tessellate.
// use: paper_lists paper_extent leb_region

@compute @workgroup_size(64)
fn paper_start(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    next_count = 0u;
    tested = 0u;
    culled = 0u;
    let horizon = params.horizon != 0u && above_ground();
    if id.x == 0u {
        control.horizon = select(0u, 1u, horizon);
    }
    if id.x < patch_start_count() {
        let p = patch_start(id.x);
        keep(p, invisible(p, horizon));
    }
    let my_out = atomicAdd(&group_out, next_count);
    atomicAdd(&group_tested, tested);
    atomicAdd(&group_culled, culled);
    workgroupBarrier();
    if local == 0u {
        first_out = atomicAdd(&control.count_out, atomicLoad(&group_out));
        atomicAdd(&control.tested, atomicLoad(&group_tested));
        atomicAdd(&control.culled, atomicLoad(&group_culled));
    }
    workgroupBarrier();
    let at = first_out + my_out;
    if next_count > 0u && at < params.list_capacity {
        list_out[at] = next[0];
    }
}
