// Where a point of the relief is, relative to the camera. Twin: src/position.rs.
// use: planet angle

fn half_angle(units: i32) -> vec2<f32> {
    if units >= -0x40000000 && units <= 0x40000000 {
        return sin_cos_small(0.5 * (f32(units) * UNIT_RAD));
    }
    return sin_cos(bitcast<u32>(units >> 1u));
}

fn difference(a: u32, b: u32) -> f32 {
    if a >= b {
        return f32(a - b);
    }
    return -f32(b - a);
}

fn camera_relative_m(view: View, s: u32, t: u32, height_m: f32) -> vec3<f32> {
    let dh = (height_m - view.camera_h_hi_m) - view.camera_h_lo_m;
    let ds = bitcast<i32>(s - view.camera_s);
    let dt = bitcast<i32>(t - view.camera_t);
    if planet.plane != 0u {
        let east = difference(s, view.camera_s);
        let north = difference(t, view.camera_t);
        return vec3(east * planet.unit_x_m, north * planet.unit_y_m, dh);
    }
    let sin0 = view.sin_lat;
    let lat1 = sin_cos_lat(t);
    let mid = sin_cos_lat((t >> 1u) + (view.camera_t >> 1u) + (t & view.camera_t & 1u));
    let dp = half_angle(dt);
    let d_sin = 2.0 * mid.y * dp.x;
    let d_cos = -2.0 * mid.x * dp.x;
    let w1 = sqrt(1.0 - planet.e2 * lat1.x * lat1.x);
    let dn = planet.a_m * planet.e2 * d_sin * (lat1.x + sin0) / (view.w0 * w1 * (view.w0 + w1));
    let h0 = view.camera_h_hi_m;
    let rho = (view.n0_m + h0 + dn + dh) * lat1.y;
    let l = sin_cos(bitcast<u32>(ds));
    let dl = half_angle(ds);
    // Beyond 90 degrees, on the other side of the axis, nothing cancels. A pole has any longitude
    // and one position.
    let x = select(
        rho * l.y - (view.n0_m + h0 + view.camera_h_lo_m) * view.cos_lat,
        (dn + dh) * lat1.y + (view.n0_m + h0) * d_cos - 2.0 * rho * dl.x * dl.x,
        (ds >= -0x40000000 && ds <= 0x40000000) || lat1.y == 0.0,
    );
    return vec3(
        x,
        rho * l.x,
        ((1.0 - planet.e2) * dn + dh) * lat1.x + ((1.0 - planet.e2) * view.n0_m + h0) * d_sin,
    );
}
