// The sun's direction at a point, its disk, the air. Twin: src/shadow/sun.rs.
// use: angle

const PI: f32 = 3.1415927;

fn sun_local(direction: vec3<f32>, s_origin: u32, s: u32, t: u32) -> vec3<f32> {
    let lon = sin_cos(s - s_origin);
    let lat = sin_cos_lat(t);
    let outwards = lon.y * direction.x + lon.x * direction.y;
    return vec3(
        lon.y * direction.y - lon.x * direction.x,
        lat.y * direction.z - lat.x * outwards,
        lat.y * outwards + lat.x * direction.z,
    );
}

fn disk_slopes(sun: vec3<f32>, disk_rad: f32) -> vec2<f32> {
    let flat = sqrt(sun.x * sun.x + sun.y * sun.y);
    if flat < 16.0 * disk_rad || disk_rad == 0.0 {
        return vec2(0.0, 0.0);
    }
    return vec2(-disk_rad / (flat + disk_rad * sun.z), disk_rad / (flat - disk_rad * sun.z));
}

fn visible_part(slope: f32, sun: vec3<f32>, disk_rad: f32) -> f32 {
    let flat = sqrt(sun.x * sun.x + sun.y * sun.y);
    if flat < 16.0 * disk_rad || disk_rad == 0.0 {
        return select(1.0, 0.0, slope > 0.0);
    }
    let under = 1.0 + slope * sun.z;
    var x = 1.0;
    if under > 0.0 {
        x = clamp(slope * flat / (under * disk_rad), -1.0, 1.0);
    }
    let area = arc_cos(x) - x * sqrt(max(1.0 - x * x, 0.0));
    return clamp(area * (1.0 / PI), 0.0, 1.0);
}

fn arc_cos(x: f32) -> f32 {
    let z = abs(x);
    let arc = sqrt(max(1.0 - z, 0.0)) * (1.5707288 + z * (-0.2121144 + z * (0.074261 + z * -0.0187293)));
    return select(arc, PI - arc, x < 0.0);
}

fn refracted(sun: vec3<f32>, density: f32) -> vec3<f32> {
    let flat = sqrt(sun.x * sun.x + sun.y * sun.y);
    if flat == 0.0 {
        return sun;
    }
    let elevation_deg = max(degrees(atan2(sun.z, flat)), -1.9);
    let argument = radians(elevation_deg + 10.3 / (elevation_deg + 5.11));
    let lift_rad = radians(max(density * 1.02 / 60.0 / tan(argument), 0.0));
    // Small: sine and cosine by their series.
    let sin_lift = lift_rad - lift_rad * lift_rad * lift_rad / 6.0;
    let cos_lift = 1.0 - 0.5 * lift_rad * lift_rad;
    let scale = (flat * cos_lift - sun.z * sin_lift) / flat;
    return vec3(sun.xy * scale, sun.z * cos_lift + flat * sin_lift);
}
