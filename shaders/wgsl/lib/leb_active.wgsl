// Whether a node is active. Twin: src/leb/active.rs.
// use: pages leb_view leb_triangle leb_virtual_cells leb_region

struct Judgement {
    region: Region,
    active_: bool,
}

struct Holders {
    level: u32,
    x: vec2<u32>,
    y: vec2<u32>,
}

fn node_level(n: Node) -> i32 {
    return i32(n.exponent) - (31 - i32(planet.m));
}

fn holders(n: Node) -> Holders {
    let level = min(u32(max(node_level(n), 0)), planet.root_level);
    let cell_shift = 31u - planet.m;
    let reach = select(0u, (2u << cell_shift) - subtree_half_width(n), node_level(n) < 0);
    let shift = cell_shift + level + 8u;
    var west = n.s - reach - 1u;
    var east = n.s + reach;
    if planet.plane != 0u {
        west = n.s - min(n.s, reach + 1u);
        east = min(east, 0x7fffffffu);
    }
    let south = n.t - min(n.t, reach + 1u);
    let north = min(n.t + reach, 0x7fffffffu);
    return Holders(level, vec2(west >> shift, east >> shift), vec2(south >> shift, north >> shift));
}

fn usable_page(level: u32, x: u32, y: u32) -> bool {
    let page = find_page(level, x, y);
    return page != NONE && (page & USABLE) != 0u;
}

fn usable(tiles: Holders) -> bool {
    let two_x = tiles.x.y != tiles.x.x;
    let two_y = tiles.y.y != tiles.y.x;
    return usable_page(tiles.level, tiles.x.x, tiles.y.x)
        && (!two_x || usable_page(tiles.level, tiles.x.y, tiles.y.x))
        && (!two_y || usable_page(tiles.level, tiles.x.x, tiles.y.y))
        && (!two_x || !two_y || usable_page(tiles.level, tiles.x.y, tiles.y.y));
}

fn stored_deviation_m(n: Node) -> f32 {
    let level = min(u32(node_level(n)), planet.root_level);
    let at = tile_place(level, n.s, n.t);
    let page = find_page(level, at.x, at.y);
    if page == NONE {
        return params.range_m;
    }
    return min(deviation_m(page & SLOT_MASK, at.column, at.row), params.range_m);
}

fn error_m(n: Node, region: Region, deviation_m: f32) -> f32 {
    let half = half_hypotenuse(n);
    let bulge = params.curvature_m * (half * half);
    let lean = params.turn_rad * half * region.half_range_m;
    return deviation_m + (bulge + lean);
}

fn along_axes(v: vec3<f32>) -> vec3<f32> {
    return vec3(
        view.right.x * v.x + view.right.y * v.y + view.right.z * v.z,
        view.up.x * v.x + view.up.y * v.y + view.up.z * v.z,
        view.forward.x * v.x + view.forward.y * v.y + view.forward.z * v.z,
    );
}

fn may_show(n: Node, region: Region, error_m: f32) -> bool {
    let c = along_axes(region.centre_m);
    let radius = radius_m(region, subtree_radius(n));
    let nearest = region.distance_m - radius;
    var cosine = params.cos_corner;
    var depth = view.forward.w;
    if nearest > 0.0 {
        let sin_ball = radius / region.distance_m;
        let cos_off = c.z / region.distance_m;
        let sin_off = sqrt(c.x * c.x + c.y * c.y) / region.distance_m;
        let cos_ball = sqrt(max(1.0 - sin_ball * sin_ball, 0.0));
        cosine = max(cosine, cos_off * cos_ball - sin_off * sin_ball);
        depth = max(depth, max(c.z - radius, nearest * cosine));
    }
    let slack = 1.0 + 2.0 * SLACK * f32(node_rank(n) + 1u);
    return view.right.w * error_m * slack > view.up.w * ((depth - error_m) * cosine);
}

fn judge(n: Node, parent: Node) -> Judgement {
    let tiles = holders(n);
    let is_usable = usable(tiles);
    let below = node_level(n) < 0;
    var cells = VirtualCells(0.0, 0.0);
    if below && is_usable {
        cells = virtual_cells(n);
    }
    let region = region_of(n, below && is_usable, cells);
    // Where the node's own deviation is not known its parent's bounds it.
    var deviation = 0.0;
    if below && is_usable {
        deviation = min(cells.deviation_m, params.range_m);
    } else if is_usable {
        deviation = stored_deviation_m(n);
    } else if node_level(parent) < 0 {
        deviation = min(virtual_cells(parent).deviation_m, params.range_m);
    } else {
        deviation = stored_deviation_m(parent);
    }
    let shows = may_show(n, region, error_m(n, region, deviation));
    if is_usable || shows {
        for (var y = 0u; y <= select(0u, 1u, tiles.y.y != tiles.y.x); y++) {
            for (var x = 0u; x <= select(0u, 1u, tiles.x.y != tiles.x.x); x++) {
                ask_page(tiles.level, tiles.x[x], tiles.y[y]);
            }
        }
    }
    return Judgement(region, shows && is_usable);
}
