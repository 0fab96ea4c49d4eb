// One pass: each patch becomes a relief triangle, or the parts of its fan and the fillers on sides
// beyond which no patch is split. Twin: paper::tessellate.
// use: paper_lists paper_extent paper_decide

var<workgroup> group_relief: atomic<u32>;
var<workgroup> group_split: atomic<u32>;
var<workgroup> group_fillers: atomic<u32>;
var<workgroup> first_relief: u32;

// What an invocation draws: three corners each.
var<private> drawn: array<vec2<u32>, 9>;
var<private> drawn_count: u32;

// Draws a triangle, unless it lies on a pole and so has no area.
fn draw(a: vec2<u32>, b: vec2<u32>, c: vec2<u32>) {
    let south = u32(a.y == 0u) + u32(b.y == 0u) + u32(c.y == 0u);
    let north = u32(a.y == 0x80000000u) + u32(b.y == 0x80000000u) + u32(c.y == 0x80000000u);
    if planet.plane == 0u && (south > 1u || north > 1u) {
        return;
    }
    drawn[3u * drawn_count] = a;
    drawn[3u * drawn_count + 1u] = b;
    drawn[3u * drawn_count + 2u] = c;
    drawn_count += 1u;
}

// Bit 3: the patch is split. Then bits 0 to 2: the halves of these sides hang. Everything is decided
// at one place of the code, so that a patch gets the same answer whoever asks.
fn judge_sides(p: Patch) -> u32 {
    var answer = 0u;
    for (var n = 0u; n < 4u; n++) {
        var asked = p;
        if n > 0u {
            let side = n - 1u;
            if patch_hangs(p, side) {
                answer |= 1u << side;
                continue;
            }
            if patch_on_edge(p, side) {
                continue;
            }
            asked = patch_beyond(p, side);
        }
        let is_split = splits(asked);
        if n > 0u {
            answer |= select(1u << (n - 1u), 0u, is_split);
        } else if is_split {
            answer = 8u;
        } else {
            return 0u;
        }
    }
    return answer;
}

fn corner(at: vec2<u32>) -> Corner {
    return Corner(at.x, at.y, corner_height_m(at), i32(corner_level(at)));
}

@compute @workgroup_size(64)
fn paper_pass(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    next_count = 0u;
    drawn_count = 0u;
    tested = 0u;
    culled = 0u;
    var is_split = false;
    if id.x < control.count_in {
        let p = list_in[id.x];
        let answer = judge_sides(p);
        is_split = answer >= 8u;
        if is_split {
            for (var side = 0u; side < 3u; side++) {
                if ((answer >> side) & 1u) == 1u {
                    draw(patch_corner(p, side), patch_corner(p, (side + 1u) % 3u), patch_midpoint(p, side));
                }
            }
            for (var n = 0u; n < 4u; n++) {
                let part = patch_part(p, n, answer & 7u);
                keep(part, invisible(part, control.horizon != 0u));
            }
        } else {
            draw(patch_corner(p, 0u), patch_corner(p, 1u), patch_corner(p, 2u));
        }
    }
    let my_out = atomicAdd(&group_out, next_count);
    let my_relief = atomicAdd(&group_relief, drawn_count);
    atomicAdd(&group_tested, tested);
    atomicAdd(&group_culled, culled);
    if is_split {
        atomicAdd(&group_split, 1u);
        atomicAdd(&group_fillers, drawn_count);
    }
    workgroupBarrier();
    if local == 0u {
        first_out = atomicAdd(&control.count_out, atomicLoad(&group_out));
        first_relief = atomicAdd(&control.relief, atomicLoad(&group_relief));
        atomicAdd(&control.tested, atomicLoad(&group_tested));
        atomicAdd(&control.culled, atomicLoad(&group_culled));
        atomicAdd(&control.split, atomicLoad(&group_split));
        atomicAdd(&control.fillers, atomicLoad(&group_fillers));
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
            relief[at] =
                ReliefTriangle(array(corner(drawn[3u * k]), corner(drawn[3u * k + 1u]), corner(drawn[3u * k + 2u])));
        }
    }
}
