// Level of detail, height and slope of the ground at a pixel. Twin: src/frame/ground.rs.
// use: pages angle

const POLE: u32 = 0x80000000u;

struct Ground {
    height_m: f32,
    east: f32,
    north: f32,
    // The finest level it is made from, and that level's height.
    level: u32,
    level_m: f32,
}

fn metres_per_unit(t: u32) -> vec2<f32> {
    if planet.plane != 0u {
        return vec2(planet.unit_x_m, planet.unit_y_m);
    }
    let lat = sin_cos_lat(t);
    let w2 = 1.0 - planet.e2 * lat.x * lat.x;
    let n = planet.a_m / sqrt(w2);
    return vec2(n * max(lat.y, 1e-7), n * (1.0 - planet.e2) / w2) * UNIT_RAD;
}

fn detail(view: View, distance_m: f32) -> f32 {
    let unit_m = select(planet.a_m * UNIT_RAD, planet.unit_y_m, planet.plane != 0u);
    let spacing_m = unit_m * f32(1u << (31u - planet.m));
    let level = log2(max(distance_m / (view.right.w * spacing_m), 1.0));
    return min(level, f32(planet.root_level));
}

fn height_near_m(level: u32, s: u32, t: u32, home: TilePlace, page: u32) -> f32 {
    let at = tile_place(level, s, t);
    if page != NONE && at.x == home.x && at.y == home.y {
        return bilinear_m(page & SLOT_MASK, level, at, s, t);
    }
    return height_m(level, s, t);
}

// The level of the finest page at `level` or coarser.
fn finest_page(level: u32, s: u32, t: u32) -> u32 {
    for (var k = level; k < planet.root_level; k++) {
        let at = tile_place(k, s, t);
        if find_page(k, at.x, at.y) != NONE {
            return k;
        }
    }
    return planet.root_level;
}

// The same; the page is asked for, and all above it then count as used.
fn finest_level(level: u32, s: u32, t: u32) -> u32 {
    let first = tile_place(level, s, t);
    ask_page(level, first.x, first.y);
    return finest_page(level, s, t);
}

fn ground(level: u32, s: u32, t: u32, per_unit: vec2<f32>) -> Ground {
    let home = tile_place(level, s, t);
    let page = find_page(level, home.x, home.y);
    let step_t = 1u << (31u - planet.m + level);
    let step_s = u32(min(f32(step_t) * (per_unit.y / per_unit.x), 5.368709e8));
    var west = s - step_s;
    var east = s + step_s;
    if planet.plane != 0u {
        west = s - min(step_s, s);
        east = min(s + step_s, POLE);
    }
    let south = t - min(step_t, t);
    let north = min(t + step_t, POLE);
    let rise_east = height_near_m(level, east, t, home, page) - height_near_m(level, west, t, home, page);
    let rise_north = height_near_m(level, s, north, home, page) - height_near_m(level, s, south, home, page);
    let here_m = height_near_m(level, s, t, home, page);
    return Ground(
        here_m,
        rise_east / (f32(east - west) * per_unit.x),
        rise_north / (f32(north - south) * per_unit.y),
        level,
        here_m,
    );
}

fn ground_between(level: f32, s: u32, t: u32, per_unit: vec2<f32>) -> Ground {
    let wanted = u32(level);
    let share = level - f32(wanted);
    let fine = finest_level(wanted, s, t);
    let a = ground(fine, s, t, per_unit);
    if share == 0.0 || fine > wanted || fine == planet.root_level {
        return a;
    }
    let b = ground(fine + 1u, s, t, per_unit);
    return Ground(
        a.height_m + (b.height_m - a.height_m) * share,
        a.east + (b.east - a.east) * share,
        a.north + (b.north - a.north) * share,
        fine,
        a.level_m,
    );
}
