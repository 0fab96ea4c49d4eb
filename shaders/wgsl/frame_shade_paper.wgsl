// Shades the pixels that `frame_draw` stored, with the paper's shadows. Twin: src/frame/shade.rs.
//
// group(2): 0 the map's numbers, of which sun and q are not read, 1 its mip pyramid, 2 its extremes.
// use: shade_pixels shadow_paper

@group(2) @binding(0) var<uniform> paper_map: ShadowPaperMap;
@group(2) @binding(1) var<storage, read> paper_heights_m: array<f32>;
@group(2) @binding(2) var<storage, read> paper_extremes: array<vec2<f32>>;

fn pixel_light(here: Ground, s: u32, t: u32, sun: vec3<f32>) -> Sunlight {
    // Texels' centres are the nodes.
    let unit = 1.0 / f32(1u << (31u - paper_map.m));
    let at = vec2(f32(s), f32(t)) * unit + 0.5;
    return paper_shadow(at, paper_bilinear_m(here.level, at.x, at.y), here.level, sun);
}
