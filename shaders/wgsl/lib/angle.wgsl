// Sine and cosine of fixed-point angles: WGSL promises the built-in ones to 2^-11 only.
// Twin: src/angle.rs.

const UNIT_RAD: f32 = 1.4629181e-9;

fn sin_cos_small(rad: f32) -> vec2<f32> {
    let x2 = rad * rad;
    let s = rad + rad * x2 * (-1.6666655e-1 + x2 * (8.332161e-3 + x2 * -1.9515296e-4));
    let c = 1.0 - 0.5 * x2 + x2 * x2 * (4.1666646e-2 + x2 * (-1.3887316e-3 + x2 * 2.4433157e-5));
    return vec2(s, c);
}

fn sin_cos(units: u32) -> vec2<f32> {
    let quarter = (units + 0x20000000u) >> 30u;
    let v = sin_cos_small(f32(bitcast<i32>(units - (quarter << 30u))) * UNIT_RAD);
    switch quarter {
        case 0u: { return v; }
        case 1u: { return vec2(v.y, -v.x); }
        case 2u: { return -v; }
        default: { return vec2(-v.y, v.x); }
    }
}

fn sin_cos_lat(t: u32) -> vec2<f32> {
    return sin_cos(t - 0x40000000u);
}
