//! Light and colours of ground and sky. Twin of `wgsl/lib/shade_light.wgsl`.

use super::style::Style;
use crate::planet::{Planet, View};
use crate::shadow::k_shadow;

/// Linear light to sRGB, 0 to 1 (IEC 61966-2-1).
#[must_use]
pub fn to_srgb(linear: [f32; 3]) -> [f32; 3] {
    linear.map(|c| {
        let c = c.clamp(0.0, 1.0);
        if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
    })
}

/// The hypsometric tint of a height, linear light.
#[must_use]
pub fn tint(style: &Style, height_m: f32) -> [f32; 3] {
    let (mut first, mut end) = (128, style.high_m);
    let base = if style.sea != 0 { 0.0 } else { style.low_m };
    if style.sea != 0 && height_m < 0.0 {
        (first, end) = (0, style.low_m);
    }
    let share = ((height_m - base) / (end - base)).clamp(0.0, 1.0);
    let at = 127.0 * share.sqrt();
    let k = (at as usize).min(126);
    let (low, high) = (style.ramp[first + k], style.ramp[first + k + 1]);
    std::array::from_fn(|c| low[c] + (high[c] - low[c]) * (at - k as f32))
}

/// By how much slopes are exaggerated, for the eye, where a pixel is `footprint_m` wide.
#[must_use]
pub fn exaggeration(style: &Style, footprint_m: f32) -> f32 {
    (footprint_m / style.exaggeration_from_m).max(1.0).powf(0.4).clamp(1.0, 8.0)
}

/// Light on ground of a slope under a sun (east, north, up).
#[must_use]
pub fn ground_light(style: &Style, slope: [f32; 2], sun: [f32; 3], visible: f32) -> [f32; 3] {
    let normal = normalize([-slope[0], -slope[1], 1.0]);
    let day = smoothstep(-0.03, 0.12, sun[2]);
    let lambert = (normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2]).max(0.0);
    let direct = lambert * k_shadow(visible, sun[2], style.dark, style.bright) * day;
    let sky = style.ambient * (0.12 + 0.88 * smoothstep(-0.25, 0.25, sun[2])) * (0.5 + 0.5 * normal[2]);
    std::array::from_fn(|k| style.sun_colour[k] * direct + style.shade_colour[k] * sky)
}

/// Air before black: thick along the horizon, thinning out with the height of the ray's lowest
/// point.
#[must_use]
pub fn sky_colour(planet: &Planet, view: &View, style: &Style, ray: [f32; 3]) -> [f32; 3] {
    let scale_m = style.sky[3];
    if scale_m <= 0.0 {
        return [0.0; 3];
    }
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let sun_axis = [view.sun[0], view.sun[1], view.sun[2]];
    let height_m = view.camera_h_hi_m;
    let up = if planet.plane != 0 { [0.0, 0.0, 1.0] } else { [view.cos_lat, 0.0, view.sin_lat] };
    let sin_ray = dot(ray, up);
    let mut lowest_m = height_m;
    let mut sun_up = dot(sun_axis, up);
    if sin_ray < 0.0 && planet.plane == 0 {
        let radius_m = view.n0_m + height_m;
        let cos_ray = (1.0 - sin_ray * sin_ray).max(0.0).sqrt();
        lowest_m = radius_m * cos_ray - view.n0_m;
        sun_up = dot(sun_axis, normalize(std::array::from_fn(|k| up[k] - ray[k] * sin_ray)));
    }
    let path = if sin_ray < 0.0 { 12.0 } else { 1.0 / (sin_ray.max(0.0) + 0.08) };
    let depth = path * (-lowest_m.max(0.0) / scale_m).exp();
    let light = (1.0 - (-0.35 * depth).exp()) * smoothstep(-0.2, 0.3, sun_up);
    [0, 1, 2].map(|k| style.sky[k] * light)
}

/// A colour for a level of detail.
#[must_use]
pub fn detail_colour(level: i32) -> [f32; 3] {
    let hue = ((level + 32) % 12) as f32 / 12.0;
    [0.0, 0.666_666_7, 0.333_333_3].map(|turn| {
        let phase = hue + turn;
        let k = ((phase - phase.floor()) * 6.0 - 3.0).abs() - 1.0;
        0.1 + 0.8 * k.clamp(0.0, 1.0)
    })
}

pub(super) fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    std::array::from_fn(|k| a[k] * (1.0 - share) + b[k] * share)
}

pub(super) fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

pub(super) fn normalize(v: [f32; 3]) -> [f32; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|c| c / length)
}
