// Sea level above the ellipsoid. Twin: src/frame/sea.rs. The kernel binds the grid as `sea_m`.

const SEA_ROWS: u32 = 91u;
const SEA_COLUMNS: u32 = 180u;

fn sea_level_m(s: u32, t: u32) -> f32 {
    if arrayLength(&sea_m) == 1u {
        return sea_m[0];
    }
    let x = f32(s) * (f32(SEA_COLUMNS) / 4294967296.0);
    let y = f32(t) * (f32(SEA_ROWS - 1u) / 2147483648.0);
    let column = u32(x) % SEA_COLUMNS;
    let row = min(u32(y), SEA_ROWS - 2u);
    let u = x - floor(x);
    let v = y - f32(row);
    let east = (column + 1u) % SEA_COLUMNS;
    let at = row * SEA_COLUMNS;
    let south = sea_m[at + column] + (sea_m[at + east] - sea_m[at + column]) * u;
    let north = sea_m[at + SEA_COLUMNS + column] + (sea_m[at + SEA_COLUMNS + east] - sea_m[at + SEA_COLUMNS + column]) * u;
    return south + (north - south) * v;
}
