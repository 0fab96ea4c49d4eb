// Triangles that cannot be seen. Twin: src/leb/cull.rs.
// use: leb_active

fn hidden(n: Node, region: Region, horizon: bool) -> bool {
    let radius = radius_m(region, half_hypotenuse(n));
    return outside(region.centre_m, radius) || (horizon && behind_horizon(region, radius));
}

fn outside(centre_m: vec3<f32>, radius_m: f32) -> bool {
    let c = along_axes(centre_m);
    return c.z + radius_m < view.forward.w
        || abs(c.x) - view.tan_x * c.z > radius_m * sqrt(1.0 + view.tan_x * view.tan_x)
        || abs(c.y) - view.tan_y * c.z > radius_m * sqrt(1.0 + view.tan_y * view.tan_y);
}

fn behind_horizon(region: Region, radius_m: f32) -> bool {
    let c = region.centre_m;
    let p = vec3(c.x * params.squash_xy, c.y * params.squash_xy, c.z * params.squash_z);
    let along = p.x * params.axis_x + p.z * params.axis_z;
    let off = vec3(p.x - along * params.axis_x, p.y, p.z - along * params.axis_z);
    let across = sqrt(off.x * off.x + off.y * off.y + off.z * off.z);
    let radius = (radius_m + SLACK * region.distance_m) * params.squash_most;
    return along - params.horizon_distance > radius && along * params.cone_sin - across * params.cone_cos > radius;
}
