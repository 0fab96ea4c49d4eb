// Nodes below level 0. Twin: src/leb/virtual_cells.rs.
// use: pages leb_triangle

struct VirtualCells {
    deviation_m: f32,
    slope: f32,
}

fn virtual_cells(n: Node) -> VirtualCells {
    let shift = n.exponent + 1u;
    let cell_shift = 31u - planet.m;
    let fold = cell_shift - shift;
    let x = n.s >> shift;
    let y = n.t >> shift;
    let upright = n.centre == 0u && ((n.s >> n.exponent) & 1u) == 0u;
    let flat_side = n.centre == 0u && !upright;
    let east = select(1, 0, upright);
    let north = select(1, 0, flat_side);
    let base = bitcast<f32>((127u - 2u * (fold + 2u - n.centre)) << 23u);
    let columns = tiles_x(0u) << 8u;
    let rows = tiles_y(0u) << 8u;
    let column_mask = select((columns << fold) - 1u, 0xffffffffu, planet.plane != 0u);
    var found = VirtualCells(0.0, 0.0);
    for (var dy = -1; dy <= north; dy++) {
        for (var dx = -1; dx <= east; dx++) {
            let near_x = select(0, dx, upright);
            let near_y = select(0, dy, flat_side);
            let far = abs(dx - near_x) + abs(dy - near_y);
            let cell = vec2(((x + u32(dx)) & column_mask) >> fold, (y + u32(dy)) >> fold);
            let near = vec2(((x + u32(near_x)) & column_mask) >> fold, (y + u32(near_y)) >> fold);
            if (far > 0 && all(cell == near)) || cell.x >= columns || cell.y >= rows {
                continue;
            }
            let shape = cell_shape(cell);
            let weight = bitcast<f32>((127u - 2u * u32(far)) << 23u);
            found.deviation_m = max(found.deviation_m, shape.x * (weight * base));
            found.slope = max(found.slope, shape.y);
        }
    }
    found.slope /= f32(1u << cell_shift);
    return found;
}

fn cell_shape(cell: vec2<u32>) -> vec2<f32> {
    let page = find_page(0u, cell.x >> 8u, cell.y >> 8u);
    if page == NONE || (page & USABLE) == 0u {
        return vec2(0.0);
    }
    let slot = page & SLOT_MASK;
    let column = cell.x & 255u;
    let row = cell.y & 255u;
    let h00 = node_m(slot, column, row);
    let h10 = node_m(slot, column + 1u, row);
    let h01 = node_m(slot, column, row + 1u);
    let h11 = node_m(slot, column + 1u, row + 1u);
    let south = h10 - h00;
    let north = h11 - h01;
    let west = h01 - h00;
    let east = h11 - h10;
    return vec2(abs(north - south), max(abs(south), abs(north)) + max(abs(west), abs(east)));
}
