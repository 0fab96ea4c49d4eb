// The mask of a plane by paper 001. Twin: src/shadow/paper.rs, PaperMap::paper_mask.
//
// group(0): 0 the map's numbers, 1 its mip pyramid, 2 its extremes. group(1): 0 the mask of the
// texels of H_0, a byte each, south row first, zeroed before: 255 lit; 1 the sums of heights,
// extremes and steps fetched, zeroed before.
// use: shadow_paper

@group(0) @binding(0) var<uniform> paper_map: ShadowPaperMap;
@group(0) @binding(1) var<storage, read> paper_heights_m: array<f32>;
@group(0) @binding(2) var<storage, read> paper_extremes: array<vec2<f32>>;
@group(1) @binding(0) var<storage, read_write> mask: array<atomic<u32>>;
@group(1) @binding(1) var<storage, read_write> fetched: array<atomic<u32>, 3>;

@compute @workgroup_size(8, 8)
fn shadow_paper(@builtin(global_invocation_id) id: vec3<u32>) {
    let side = 1u << paper_map.m;
    if id.x >= side || id.y >= side {
        return;
    }
    let at = vec2<f32>(id.xy) + 0.5;
    let q = paper_map.q;
    let light = paper_shadow(at, paper_bilinear_m(q, at.x, at.y), q, paper_map.sun.xyz);
    let texel = id.y * side + id.x;
    atomicOr(&mask[texel / 4u], u32(light.visible * 255.0 + 0.5) << (8u * (texel % 4u)));
    atomicAdd(&fetched[0], light.heights);
    atomicAdd(&fetched[1], light.extremes);
    atomicAdd(&fetched[2], light.steps);
}
