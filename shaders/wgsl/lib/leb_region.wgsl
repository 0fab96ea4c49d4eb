// Where all that may be drawn under a node lies. Twin: src/leb/region.rs.
// use: pages position leb_view leb_triangle leb_virtual_cells

struct Region {
    centre_m: vec3<f32>,
    distance_m: f32,
    half_range_m: f32,
    slack_m: f32,
}

fn region_of(n: Node, known: bool, cells: VirtualCells) -> Region {
    let rank = f32(node_rank(n) + 1u);
    var range = interval_m(n);
    if known {
        let height = height_m(0u, n.s, n.t);
        let reach = 1.01 * cells.slope * f32(subtree_half_width(n)) + params.slack_m * rank;
        range = vec2(max(range.x, height - reach), min(range.y, height + reach));
    }
    let centre = camera_relative_m(view, n.s, n.t, 0.5 * (range.x + range.y));
    let distance = sqrt(centre.x * centre.x + centre.y * centre.y + centre.z * centre.z);
    return Region(centre, distance, 0.5 * (range.y - range.x), (SLACK * distance + params.slack_m) * rank);
}

fn radius_m(region: Region, units: f32) -> f32 {
    return params.reach_m * units + region.half_range_m + region.slack_m;
}

fn interval_m(n: Node) -> vec2<f32> {
    let whole = vec2(planet.min_m, planet.max_m);
    let cell_shift = 31u - planet.m;
    let level = max(n.exponent + 2u, cell_shift) - cell_shift;
    if level > planet.root_level {
        return whole;
    }
    let reach = subtree_half_width(n);
    let shift = cell_shift + level + 1u;
    var west = n.s - reach;
    var east = n.s + reach;
    if planet.plane != 0u {
        west = n.s - min(n.s, reach);
        east = min(east, 0x80000000u);
    }
    let south = n.t - min(n.t, reach);
    let north = min(n.t + reach, 0x80000000u);
    let blocks_x = vec2(west >> shift, (east - 1u) >> shift);
    let blocks_y = vec2(south >> shift, (north - 1u) >> shift);
    var range = block_m(level, blocks_x.x, blocks_y.x);
    if blocks_x.y != blocks_x.x {
        range = joined(range, block_m(level, blocks_x.y, blocks_y.x));
    }
    if blocks_y.y != blocks_y.x {
        range = joined(range, block_m(level, blocks_x.x, blocks_y.y));
        if blocks_x.y != blocks_x.x {
            range = joined(range, block_m(level, blocks_x.y, blocks_y.y));
        }
    }
    return vec2(max(range.x, whole.x), min(range.y, whole.y));
}

fn joined(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2(min(a.x, b.x), max(a.y, b.y));
}

fn block_m(level: u32, x: u32, y: u32) -> vec2<f32> {
    for (var up = 0u; up <= planet.root_level - level; up++) {
        let at = vec2(x >> up, y >> up);
        let page = find_page(level + up, at.x / BLOCKS, at.y / BLOCKS);
        if page != NONE {
            return extremes_m(page & SLOT_MASK, at.x % BLOCKS, at.y % BLOCKS);
        }
    }
    return vec2(planet.min_m, planet.max_m);
}

fn above_ground() -> bool {
    let shift = 32u - planet.m;
    let last = (1u << (planet.m - 1u)) - 1u;
    let range = block_m(0u, view.camera_s >> shift, min(view.camera_t >> shift, last));
    return view.camera_h_hi_m > range.y;
}
