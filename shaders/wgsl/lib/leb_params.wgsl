// What the scheme knows of planet and view. Twin: src/leb/params.rs.

const SLACK: f32 = 2e-6;

struct LebParams {
    reach_m: f32,
    curvature_m: f32,
    turn_rad: f32,
    range_m: f32,
    slack_m: f32,
    cos_corner: f32,
    horizon: u32,
    list_capacity: u32,
    squash_xy: f32,
    squash_z: f32,
    squash_most: f32,
    relief_capacity: u32,
    axis_x: f32,
    axis_z: f32,
    horizon_distance: f32,
    cone_sin: f32,
    cone_cos: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}
