// Where a point of the relief is, relative to the camera. Twin: src/position.rs.
// use: planet angle

fn half_angle(rad: f32) -> vec2<f32> {
    let v = sin_cos_small(0.25 * rad);
    return vec2(2.0 * v.x * v.y, v.y * v.y - v.x * v.x);
}

fn camera_relative_m(view: View, s: u32, t: u32, height_m: f32) -> vec3<f32> {
    let dh = (height_m - view.camera_h_hi_m) - view.camera_h_lo_m;
    let ds = f32(bitcast<i32>(s - view.camera_s));
    let dt = f32(bitcast<i32>(t - view.camera_t));
    if planet.plane != 0u {
        return vec3(ds * planet.unit_x_m, dt * planet.unit_y_m, dh);
    }
    let sin0 = view.sin_lat;
    let cos0 = view.cos_lat;
    let lat1 = sin_cos_lat(t);
    let dp = half_angle(dt * UNIT_RAD);
    let sin_m = sin0 * dp.y + cos0 * dp.x;
    let cos_m = cos0 * dp.y - sin0 * dp.x;
    let d_sin = 2.0 * cos_m * dp.x;
    let d_cos = -2.0 * sin_m * dp.x;
    let w1 = sqrt(1.0 - planet.e2 * lat1.x * lat1.x);
    let dn = planet.a_m * planet.e2 * d_sin * (lat1.x + sin0) / (view.w0 * w1 * (view.w0 + w1));
    let h0 = view.camera_h_hi_m;
    let rho = (view.n0_m + h0 + dn + dh) * lat1.y;
    let dl = half_angle(ds * UNIT_RAD);
    return vec3(
        (dn + dh) * lat1.y + (view.n0_m + h0) * d_cos - 2.0 * rho * dl.x * dl.x,
        2.0 * rho * dl.x * dl.y,
        ((1.0 - planet.e2) * dn + dh) * lat1.x + ((1.0 - planet.e2) * view.n0_m + h0) * d_sin,
    );
}
