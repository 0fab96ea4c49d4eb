// Between passes: the list that was written is the next to be read. One invocation.
// use: leb_params leb_control

// Arguments of an indirect dispatch, one word to spare, and of an indirect draw.
struct LebArgs {
    groups: array<u32, 4>,
    vertices: u32,
    instances: u32,
    first_vertex: u32,
    first_instance: u32,
}

@group(0) @binding(0) var<uniform> params: LebParams;
@group(0) @binding(1) var<storage, read_write> control: LebControl;
@group(0) @binding(2) var<storage, read_write> args: LebArgs;

@compute @workgroup_size(1)
fn leb_args() {
    let wanted = atomicExchange(&control.count_out, 0u);
    let count = min(wanted, params.list_capacity);
    let drawn = atomicLoad(&control.relief);
    if wanted > params.list_capacity || drawn > params.relief_capacity {
        atomicStore(&control.overflow, 1u);
    }
    control.count_in = count;
    control.passes += select(0u, 1u, count > 0u);
    args.groups = array((count + 63u) / 64u, 1u, 1u, 0u);
    args.vertices = 3u * min(drawn, params.relief_capacity);
    args.instances = 1u;
    args.first_vertex = 0u;
    args.first_instance = 0u;
}
