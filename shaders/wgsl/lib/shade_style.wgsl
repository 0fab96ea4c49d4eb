// How a picture looks. Twin: src/frame/style.rs.

struct Style {
    overlay: u32,
    shadow: u32,
    sea: u32,
    air: f32,
    low_m: f32,
    high_m: f32,
    ambient: f32,
    exaggeration_from_m: f32,
    dark: f32,
    bright: f32,
    padding_0: u32,
    padding_1: u32,
    sun_colour: vec4<f32>,
    shade_colour: vec4<f32>,
    sky: vec4<f32>,
    ramp: array<vec4<f32>, 256>,
}

@group(1) @binding(1) var<uniform> style: Style;

const NO_OVERLAY: u32 = 0u;
const DETAIL: u32 = 2u;
const PAGES: u32 = 3u;
const ERROR: u32 = 4u;
const NO_SHADOW: u32 = 0u;
const SEA_GRID: u32 = 2u;
