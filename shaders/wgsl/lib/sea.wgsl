// Sea level above the ellipsoid. Twin: src/frame/sea.rs. The kernel binds the grid as `sea_m`.

const SEA_ROWS: u32 = 91u;
const SEA_COLUMNS: u32 = 180u;

fn sea_node_m(column: u32, row: u32) -> f32 {
    let at = row * SEA_COLUMNS + column;
    return sea_m[at / 4u][at % 4u];
}

fn sea_level_m(s: u32, t: u32) -> f32 {
    let x = f32(s) * (f32(SEA_COLUMNS) / 4294967296.0);
    let y = f32(t) * (f32(SEA_ROWS - 1u) / 2147483648.0);
    let column = u32(x) % SEA_COLUMNS;
    let row = min(u32(y), SEA_ROWS - 2u);
    let u = x - floor(x);
    let v = y - f32(row);
    let east = (column + 1u) % SEA_COLUMNS;
    let south = sea_node_m(column, row) + (sea_node_m(east, row) - sea_node_m(column, row)) * u;
    let north = sea_node_m(column, row + 1u) + (sea_node_m(east, row + 1u) - sea_node_m(column, row + 1u)) * u;
    return south + (north - south) * v;
}
