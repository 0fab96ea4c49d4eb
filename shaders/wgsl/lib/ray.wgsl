// A straight ray in geodetic terms. Twin: src/ray.rs.
// use: planet angle

const FAR: f32 = 1.0e30;

struct Ray {
    s: u32,
    t: u32,
    height_m: f32,
    // East, north, up at the start.
    direction: vec3<f32>,
    sin_lat: f32,
    cos_lat: f32,
    w0: f32,
    n0_m: f32,
    r0_m: f32,
    rho0_m: f32,
    out: f32,
    axial: f32,
    turn_m: f32,
    turn: f32,
}

struct Meridian {
    offset_m: f32,
    rate: f32,
}

struct Parallel {
    north_m: f32,
    rate: f32,
    sin: f32,
    cos: f32,
    sum_m: f32,
    shift_m: f32,
}

fn ray_heading(x: f32, y: f32) -> u32 {
    let ax = abs(x);
    let ay = abs(y);
    let long = max(ax, ay);
    if long == 0.0 {
        return 0u;
    }
    let short = min(ax, ay);
    let folded = short > 0.41421357 * long;
    var z = short / long;
    if folded {
        z = (short - long) / (short + long);
    }
    let z2 = z * z;
    let poly = z + z * z2 * (-3.333295e-1 + z2 * (1.9977711e-1 + z2 * (-1.3877686e-1 + z2 * 8.053744e-2)));
    var units = bitcast<u32>(i32(poly * (1.0 / UNIT_RAD)));
    if folded {
        units += 0x20000000u;
    }
    if ay > ax {
        units = 0x40000000u - units;
    }
    if x < 0.0 {
        units = 0x80000000u - units;
    }
    return select(units, 0u - units, y < 0.0);
}

fn ray_from(s: u32, t: u32, height_m: f32, direction: vec3<f32>) -> Ray {
    var ray = Ray(s, t, height_m, direction, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    if planet.plane != 0u {
        ray.r0_m = FAR;
        ray.turn_m = direction.y;
        return ray;
    }
    let lat = sin_cos_lat(t);
    ray.sin_lat = lat.x;
    ray.cos_lat = lat.y;
    if lat.y == 0.0 {
        ray.s = s + ray_heading(-direction.y * lat.x, direction.x);
        let flat = sqrt(direction.x * direction.x + direction.y * direction.y);
        ray.direction = vec3(0.0, -lat.x * flat, direction.z);
    }
    ray.w0 = sqrt(1.0 - planet.e2 * lat.x * lat.x);
    ray.n0_m = planet.a_m / ray.w0;
    ray.r0_m = ray.n0_m + height_m;
    ray.rho0_m = ray.r0_m * lat.y;
    ray.out = ray.direction.z * lat.y - ray.direction.y * lat.x;
    ray.axial = ray.direction.z * lat.x + ray.direction.y * lat.y;
    ray.turn_m = ray.r0_m * lat.y * ray.direction.y;
    ray.turn = ray.axial * ray.direction.z - lat.x;
    return ray;
}

fn ray_bend_m(ray: Ray, at_m: f32) -> f32 {
    if planet.plane != 0u {
        return 0.0;
    }
    let x = at_m * ray.out;
    let y = at_m * ray.direction.x;
    let rx = ray.rho0_m + x;
    let square = x * x + y * y;
    let sum = max(sqrt(rx * rx + y * y) + ray.rho0_m, 1.0e-20);
    let d_rho = (2.0 * ray.rho0_m * x + square) / sum;
    return (square - x * d_rho) / sum;
}

fn ray_rise_m(ray: Ray, at_m: f32) -> f32 {
    if planet.plane != 0u {
        return at_m * ray.direction.z;
    }
    let bend_m = ray_bend_m(ray, at_m);
    let x = at_m * ray.direction.z + ray.cos_lat * bend_m;
    let n = at_m * ray.direction.y - ray.sin_lat * bend_m;
    let r0 = ray.r0_m;
    var up_m = x;
    var along_m = n;
    var d_n = 0.0;
    let rounds = select(1 + i32(abs(planet.e2) > 0.02), 0, planet.e2 == 0.0);
    for (var round = 0; round < rounds; round++) {
        let radius = sqrt((r0 + up_m) * (r0 + up_m) + along_m * along_m);
        let sin = along_m / radius;
        let cos = (r0 + up_m) / radius;
        let d_sin = ray.cos_lat * sin - ray.sin_lat * sin * sin / (1.0 + cos);
        let shift = ray_normal_shift_m(ray, ray.sin_lat + d_sin, d_sin);
        d_n = shift.x;
        up_m = x + ray.sin_lat * shift.y;
        along_m = n + ray.cos_lat * shift.y;
    }
    let radius = sqrt((r0 + up_m) * (r0 + up_m) + along_m * along_m);
    return (2.0 * r0 * up_m + up_m * up_m + along_m * along_m) / (radius + r0) - d_n;
}

fn ray_normal_shift_m(ray: Ray, sin1: f32, d_sin: f32) -> vec2<f32> {
    let w1 = sqrt(1.0 - planet.e2 * sin1 * sin1);
    let d_n = planet.a_m * planet.e2 * d_sin * (sin1 + ray.sin_lat) / (ray.w0 * w1 * (ray.w0 + w1));
    return vec2(d_n, planet.e2 * ((ray.n0_m + d_n) * d_sin + d_n * ray.sin_lat));
}

fn ray_difference(a: u32, b: u32) -> f32 {
    if a >= b {
        return f32(a - b);
    }
    return -f32(b - a);
}

fn ray_meridian(ray: Ray, s: u32) -> Meridian {
    if planet.plane != 0u {
        return Meridian(ray_difference(s, ray.s) * planet.unit_x_m, ray.direction.x);
    }
    let turn = sin_cos(s - ray.s);
    return Meridian(ray.rho0_m * turn.x, ray.direction.x * turn.y - ray.out * turn.x);
}

fn ray_east_of_m(meridian: Meridian, at_m: f32) -> f32 {
    return meridian.rate * at_m - meridian.offset_m;
}

fn ray_meridian_at_m(ray: Ray, meridian: Meridian) -> f32 {
    let sign = select(-1.0, 1.0, ray.direction.x > 0.0);
    return ray_line_at_m(sign * meridian.offset_m, sign * meridian.rate);
}

fn ray_line_at_m(ahead_m: f32, rate: f32) -> f32 {
    if ahead_m > 0.0 && rate > 0.0 && ahead_m < FAR * rate {
        return ahead_m / rate;
    }
    return FAR;
}

fn ray_parallel(ray: Ray, t: u32) -> Parallel {
    let dt = ray_difference(t, ray.t);
    if planet.plane != 0u {
        return Parallel(-dt * planet.unit_y_m, ray.direction.y, 0.0, 1.0, 0.0, 0.0);
    }
    let lat = sin_cos_lat(t);
    let half = sin_cos_small(0.5 * UNIT_RAD * dt);
    let sin_d = 2.0 * half.x * half.y;
    let one_less_cos = 2.0 * half.x * half.x;
    let d_sin = sin_d * ray.cos_lat - ray.sin_lat * one_less_cos;
    let shift_m = ray_normal_shift_m(ray, lat.x, d_sin).y;
    return Parallel(
        lat.y * shift_m - ray.r0_m * sin_d,
        ray.direction.y - ray.direction.y * one_less_cos - ray.direction.z * sin_d,
        lat.x,
        lat.y,
        lat.y * (ray.r0_m * ray.sin_lat + shift_m) + lat.x * ray.rho0_m,
        shift_m,
    );
}

fn ray_north_of_m(p: Parallel, at_m: f32, bend_m: f32) -> f32 {
    return p.north_m + p.rate * at_m - p.sin * bend_m;
}

fn ray_parallel_at_m(ray: Ray, p: Parallel, northward: bool) -> f32 {
    let sign = select(-1.0, 1.0, northward);
    if planet.plane != 0u {
        return ray_line_at_m(-sign * p.north_m, sign * p.rate);
    }
    let q = p.cos * (ray.r0_m * ray.direction.y - ray.out * p.shift_m);
    let c = p.north_m * p.sum_m;
    let d = q * q + ray.direction.x * ray.direction.x * c;
    if d < 0.0 {
        return FAR;
    }
    let root = sign * p.sin * sqrt(d);
    let b = 0.5 * (p.sum_m * p.rate + p.north_m * (p.cos * ray.axial + p.sin * ray.out));
    var over = -c;
    var under = b + root;
    if b * root < 0.0 {
        over = root - b;
        under = (ray.axial - p.sin) * (ray.axial + p.sin);
    }
    if abs(over) >= FAR * abs(under) {
        return FAR;
    }
    let at_m = over / under;
    let z = ray.r0_m * ray.sin_lat + p.shift_m + at_m * ray.axial;
    if at_m > 0.0 && z * p.sin >= 0.0 {
        return at_m;
    }
    return FAR;
}

fn ray_moves_north(ray: Ray, at_m: f32) -> bool {
    let rate = ray.turn_m + ray.turn * at_m;
    if rate == 0.0 {
        return ray.turn > 0.0;
    }
    return rate > 0.0;
}
