// The relief of the pages, as rays fetch it. Twin: src/shadow/pages.rs.
// use: pages

// The tile last fetched from and its page.
var<private> shadow_tile: vec3<u32> = vec3(NONE, 0u, 0u);
var<private> shadow_tile_page: u32 = NONE;

fn shadow_page(level: u32, x: u32, y: u32) -> u32 {
    if level > planet.root_level {
        return NONE;
    }
    let tile = vec3(level, x, y);
    if any(tile != shadow_tile) {
        ask_page(level, x, y);
        shadow_tile = tile;
        shadow_tile_page = find_page(level, x, y);
    }
    return shadow_tile_page;
}

// Page of a block of extremes, or of a cell.
fn shadow_block_page(level: u32, x: u32, y: u32) -> u32 {
    return shadow_page(level, x / BLOCKS, y / BLOCKS);
}

fn shadow_cell_page(level: u32, x: u32, y: u32) -> u32 {
    return shadow_page(level, x / CELLS, y / CELLS);
}

fn shadow_extremes_m(page: u32, x: u32, y: u32) -> vec2<f32> {
    return extremes_m(page & SLOT_MASK, x % BLOCKS, y % BLOCKS);
}

fn shadow_corners_m(page: u32, x: u32, y: u32) -> vec4<f32> {
    let slot = page & SLOT_MASK;
    let column = x % CELLS;
    let row = y % CELLS;
    return vec4(
        node_m(slot, column, row),
        node_m(slot, column + 1u, row),
        node_m(slot, column, row + 1u),
        node_m(slot, column + 1u, row + 1u),
    );
}
