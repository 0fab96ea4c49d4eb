// Where the relief over a patch lies, and whether it may be seen. Twin: src/paper/extent.rs.
// use: pages position leb_view leb_region leb_cull paper_patch

fn square_interval_m(p: Patch) -> vec2<f32> {
    let o = patch_midpoint(p, 1u);
    for (var level = u32(max(patch_level(p), 0)); level <= planet.root_level; level++) {
        let at = tile_place(level, o.x, o.y);
        let page = find_page(level, at.x, at.y);
        if page != NONE {
            return extremes_m(page & SLOT_MASK, at.column / 2u, at.row / 2u);
        }
    }
    return vec2(planet.min_m, planet.max_m);
}

fn invisible(p: Patch, horizon: bool) -> bool {
    let n = patch_node(p);
    let range = square_interval_m(p);
    let c = camera_relative_m(view, n.s, n.t, 0.5 * (range.x + range.y));
    let distance = sqrt(c.x * c.x + c.y * c.y + c.z * c.z);
    let slack = SLACK * distance + params.slack_m;
    return hidden(n, Region(c, distance, 0.5 * (range.y - range.x), slack), horizon);
}
