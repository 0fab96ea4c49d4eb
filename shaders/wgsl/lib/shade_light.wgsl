// Light and colours of ground and sky. Twin: src/frame/light.rs.
// use: planet angle shade_style

fn to_srgb(linear: vec3<f32>) -> vec3<f32> {
    let c = clamp(linear, vec3(0.0), vec3(1.0));
    return select(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, c <= vec3(0.0031308));
}

fn tint(height_m: f32) -> vec3<f32> {
    var first = 128u;
    var end = style.high_m;
    var base = select(style.low_m, 0.0, style.sea != 0u);
    if style.sea != 0u && height_m < 0.0 {
        first = 0u;
        end = style.low_m;
    }
    let share = clamp((height_m - base) / (end - base), 0.0, 1.0);
    let at = 127.0 * sqrt(share);
    let k = min(u32(at), 126u);
    let low = style.ramp[first + k].xyz;
    let high = style.ramp[first + k + 1u].xyz;
    return low + (high - low) * (at - f32(k));
}

fn exaggeration(footprint_m: f32) -> f32 {
    return clamp(pow(max(footprint_m / style.exaggeration_from_m, 1.0), 0.4), 1.0, 8.0);
}

fn ground_light(slope: vec2<f32>, sun: vec3<f32>, visible: f32) -> vec3<f32> {
    let normal = normalize(vec3(-slope, 1.0));
    // What exaggerated slopes would catch beyond the terminator is no light.
    let day = smoothstep(-0.03, 0.12, sun.z);
    let shaded = style.dark + (style.bright - style.dark) * max(sun.z, 0.0);
    let direct = max(dot(normal, sun), 0.0) * (shaded + (1.0 - shaded) * visible) * day;
    let sky = style.ambient * (0.12 + 0.88 * smoothstep(-0.25, 0.25, sun.z)) * (0.5 + 0.5 * normal.z);
    return style.sun_colour.xyz * direct + style.shade_colour.xyz * sky;
}

fn sky_colour(view: View, ray: vec3<f32>) -> vec3<f32> {
    let scale_m = style.sky.w;
    if scale_m <= 0.0 {
        return vec3(0.0);
    }
    let height_m = view.camera_h_hi_m;
    let up = select(vec3(view.cos_lat, 0.0, view.sin_lat), vec3(0.0, 0.0, 1.0), planet.plane != 0u);
    let sin_ray = dot(ray, up);
    var lowest_m = height_m;
    var sun_up = dot(view.sun.xyz, up);
    if sin_ray < 0.0 && planet.plane == 0u {
        // The ray's lowest point, where it is horizontal.
        let radius_m = view.n0_m + height_m;
        let cos_ray = sqrt(max(1.0 - sin_ray * sin_ray, 0.0));
        lowest_m = radius_m * cos_ray - view.n0_m;
        sun_up = dot(view.sun.xyz, normalize(up - ray * sin_ray));
    }
    let path = select(1.0 / (max(sin_ray, 0.0) + 0.08), 12.0, sin_ray < 0.0);
    let depth = path * exp(-max(lowest_m, 0.0) / scale_m);
    return style.sky.xyz * ((1.0 - exp(-0.35 * depth)) * smoothstep(-0.2, 0.3, sun_up));
}

fn detail_colour(level: i32) -> vec3<f32> {
    let hue = f32((level + 32) % 12) / 12.0;
    let k = abs(fract(vec3(hue) + vec3(0.0, 0.6666667, 0.3333333)) * 6.0 - 3.0) - 1.0;
    return 0.1 + 0.8 * clamp(k, vec3(0.0), vec3(1.0));
}
