// One pass: each triangle is culled, drawn or halved, and its halves likewise. Twin:
// leb::tessellate. A workgroup counts what it yields before it takes places in the lists.
// use: leb_lists leb_active leb_cull

var<workgroup> group_out: atomic<u32>;
var<workgroup> group_relief: atomic<u32>;
var<workgroup> group_tested: atomic<u32>;
var<workgroup> group_culled: atomic<u32>;
var<workgroup> first_out: u32;
var<workgroup> first_relief: u32;

// What an invocation yields.
var<private> next: array<Triangle, 4>;
var<private> next_count: u32;
var<private> drawn: array<Triangle, 2>;
var<private> drawn_count: u32;
var<private> tested: u32;
var<private> culled: u32;

// True when the triangle is to be halved; else it has been culled or drawn.
fn settle(t: Triangle) -> bool {
    let n = triangle_node(t);
    let judgement = judge(n, triangle_parent(t));
    tested += 1u;
    if hidden(n, judgement.region, control.horizon != 0u) {
        culled += 1u;
        return false;
    }
    if judgement.active_ && divisible(t) {
        return true;
    }
    if has_area(t) {
        drawn[drawn_count] = t;
        drawn_count += 1u;
    }
    return false;
}

// False where two corners are the same pole.
fn has_area(t: Triangle) -> bool {
    if planet.plane != 0u {
        return true;
    }
    let a = triangle_corner(t, 0u).y;
    let b = triangle_corner(t, 1u).y;
    let c = triangle_corner(t, 2u).y;
    let south = u32(a == 0u) + u32(b == 0u) + u32(c == 0u);
    let north = u32(a == 0x80000000u) + u32(b == 0x80000000u) + u32(c == 0x80000000u);
    return south < 2u && north < 2u;
}

fn corner(t: Triangle, k: u32) -> Corner {
    let at = triangle_corner(t, k);
    let level = i32(min(countTrailingZeros(at.x | at.y), 31u)) - (31 - i32(planet.m));
    let page_level = u32(clamp(level, 0, i32(planet.root_level)));
    return Corner(at.x, at.y, height_m(page_level, at.x, at.y), level);
}

@compute @workgroup_size(64)
fn leb_pass(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    next_count = 0u;
    drawn_count = 0u;
    tested = 0u;
    culled = 0u;
    if id.x < control.count_in {
        let t = list_in[id.x];
        if settle(t) {
            for (var k = 0u; k < 2u; k++) {
                let half = triangle_half(t, k == 1u);
                if settle(half) {
                    next[next_count] = triangle_half(half, false);
                    next[next_count + 1u] = triangle_half(half, true);
                    next_count += 2u;
                }
            }
        }
    }
    let my_out = atomicAdd(&group_out, next_count);
    let my_relief = atomicAdd(&group_relief, drawn_count);
    atomicAdd(&group_tested, tested);
    atomicAdd(&group_culled, culled);
    workgroupBarrier();
    if local == 0u {
        first_out = atomicAdd(&control.count_out, atomicLoad(&group_out));
        first_relief = atomicAdd(&control.relief, atomicLoad(&group_relief));
        atomicAdd(&control.tested, atomicLoad(&group_tested));
        atomicAdd(&control.culled, atomicLoad(&group_culled));
    }
    workgroupBarrier();
    for (var k = 0u; k < next_count; k++) {
        let at = first_out + my_out + k;
        if at < params.list_capacity {
            list_out[at] = next[k];
        }
    }
    for (var k = 0u; k < drawn_count; k++) {
        let at = first_relief + my_relief + k;
        if at < params.relief_capacity {
            let t = drawn[k];
            relief[at] = ReliefTriangle(array(corner(t, 0u), corner(t, 1u), corner(t, 2u)));
        }
    }
}
