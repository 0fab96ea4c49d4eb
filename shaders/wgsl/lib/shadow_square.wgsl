// Squares of the map and how a ray leaves them. Twin: src/shadow/square.rs.
// use: ray pages

struct Square {
    // NONE: there is no such square.
    level: u32,
    x: u32,
    y: u32,
}

struct Exit {
    at_m: f32,
    dx: i32,
    dy: i32,
}

fn square_shift(level: u32) -> u32 {
    return 31u - planet.m + level;
}

fn square_columns(level: u32) -> u32 {
    return 1u << (planet.m + 1u - planet.plane - level);
}

fn square_first(ray: Ray, level: u32) -> Square {
    let shift = square_shift(level);
    let west = ray.direction.x < 0.0;
    let south = !ray_moves_north(ray, 0.0);
    let columns = square_columns(level);
    let rows = 1u << (planet.m - level);
    if planet.plane != 0u {
        let off_x = select(ray.direction.x > 0.0 && ray.s >> shift == columns, ray.s == 0u, west);
        let off_y = select(ray.t >> shift == rows, ray.direction.y < 0.0 && ray.t == 0u, south);
        if off_x || off_y {
            return Square(NONE, 0u, 0u);
        }
    }
    let x = (ray.s - u32(west)) >> shift;
    let y = (ray.t - u32(south && ray.t > 0u)) >> shift;
    return Square(level, min(x, columns - 1u), min(y, rows - 1u));
}

fn square_exit(ray: Ray, square: Square, at_m: f32, over_pole: bool) -> Exit {
    let shift = square_shift(square.level);
    let east = ray.direction.x;
    var x_at_m = FAR;
    if east != 0.0 {
        let border = square.x + u32(east > 0.0);
        x_at_m = max(ray_meridian_at_m(ray, ray_meridian(ray, border << shift)), at_m);
    }
    let north = select(ray_moves_north(ray, at_m), ray.turn > 0.0, over_pole);
    var ahead = north;
    let south_t = square.y << shift;
    let north_t = (square.y + 1u) << shift;
    var y_at_m = ray_parallel_at_m(ray, ray_parallel(ray, select(south_t, north_t, north)), north);
    if y_at_m == FAR && ray.turn != 0.0 && north != (ray.turn > 0.0) {
        ahead = !north;
        y_at_m = ray_parallel_at_m(ray, ray_parallel(ray, select(north_t, south_t, north)), !north);
    }
    y_at_m = max(y_at_m, at_m);
    let dx = select(-1, 1, east > 0.0);
    let dy = select(-1, 1, ahead);
    if x_at_m < y_at_m {
        return Exit(x_at_m, dx, 0);
    }
    if y_at_m < x_at_m {
        return Exit(y_at_m, 0, dy);
    }
    if x_at_m < FAR {
        return Exit(x_at_m, dx, dy);
    }
    return Exit(FAR, 0, 0);
}

fn square_child(ray: Ray, square: Square, at_m: f32, over_pole: bool) -> Square {
    let level = square.level - 1u;
    let shift = square_shift(level);
    let x = 2u * square.x;
    let y = 2u * square.y;
    let kept = select(ray.s, ray.s ^ 0x80000000u, over_pole) >> shift;
    var east = kept > x;
    if ray.direction.x != 0.0 {
        east = ray_east_of_m(ray_meridian(ray, (x + 1u) << shift), at_m) >= 0.0;
    }
    let north = ray_north_of_m(ray_parallel(ray, (y + 1u) << shift), at_m, ray_bend_m(ray, at_m)) >= 0.0;
    return Square(level, x + u32(east), y + u32(north));
}

fn shadow_near_m(level: u32) -> f32 {
    let units = f32(1u << square_shift(level));
    if planet.plane != 0u {
        return 0.01 * (units * min(planet.unit_x_m, planet.unit_y_m));
    }
    return 0.01 * (units * UNIT_RAD * planet.a_m);
}

fn square_parent(square: Square) -> Square {
    return Square(square.level + 1u, square.x >> 1u, square.y >> 1u);
}

fn square_beside(square: Square, dx: i32, dy: i32) -> Square {
    let columns = square_columns(square.level);
    let rows = 1u << (planet.m - square.level);
    let x = square.x + bitcast<u32>(dx);
    let y = square.y + bitcast<u32>(dy);
    if planet.plane != 0u {
        return Square(select(NONE, square.level, x < columns && y < rows), x, y);
    }
    let turn = select(columns >> 1u, 0u, y < rows);
    return Square(square.level, (x ^ turn) & (columns - 1u), select(square.y, y, y < rows));
}
