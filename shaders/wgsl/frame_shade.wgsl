// Shades the pixels that `frame_draw` stored, with shadows by exact rays. Twin: src/frame/shade.rs.
// use: shade_pixels shadow

fn pixel_light(here: Ground, s: u32, t: u32, sun: vec3<f32>) -> Sunlight {
    return shadow_exact(s, t, here.level_m, here.level, sun, view.sun.w);
}
