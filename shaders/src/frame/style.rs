//! How a picture looks: hypsometric tints, light, sky, overlays.

use bytemuck::{Pod, Zeroable};
use relief_formats::body::Body;

/// What is drawn over the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None = 0,
    /// The triangles' sides.
    Wireframe = 1,
    /// The triangles' sides and a colour for each level of detail.
    Detail = 2,
    /// A colour for each page that heights are taken from, with its borders; striped where it stands
    /// in for a finer one that is missing.
    Pages = 3,
    /// The error of the drawn surface, blue to white at the threshold to red at twice it; striped
    /// where S_0 is not at hand and the finest page that is counts as the truth.
    Error = 4,
}

/// How the relief's shadows are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum Shadow {
    /// Not at all.
    None = 0,
    /// Rays through the pyramid of extremes ([`crate::shadow::exact`]).
    #[default]
    Exact = 1,
    /// The paper's rays ([`crate::shadow::paper`]), over a plane only: a baseline.
    Paper = 2,
}

/// Where land ends and sea begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum Shore {
    /// Nowhere.
    #[default]
    None = 0,
    /// At height 0.
    Ellipsoid = 1,
    /// At the level of [`super::sea`].
    Grid = 2,
}

/// `struct Style` of `wgsl/lib/shade_style.wgsl`. Colours are linear light.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Style {
    /// An [`Overlay`].
    pub overlay: u32,
    /// A [`Shadow`].
    pub shadow: u32,
    /// A [`Shore`].
    pub sea: u32,
    /// Density of the air that lifts the sun, 1 on Earth at sea level; 0 for no refraction.
    pub air: f32,
    /// Height of the ramp's low end, metres: of the deepest water, or of the lowest land.
    pub low_m: f32,
    /// Height of the ramp's high end, metres.
    pub high_m: f32,
    /// Light from the sky on level ground by day.
    pub ambient: f32,
    /// Slopes are exaggerated, for the eye only, where a pixel is wider than this, metres.
    pub exaggeration_from_m: f32,
    /// Share of the sun's light that is left in shadow: k_dark of paper 001, eq. 1.
    pub dark: f32,
    /// The same under a sun in the zenith: `k_bright`.
    pub bright: f32,
    /// Zero.
    pub padding: [u32; 2],
    /// Light of the sun.
    pub sun_colour: [f32; 4],
    /// Light of the sky.
    pub shade_colour: [f32; 4],
    /// Colour of the air before black; fourth: its scale height in metres, 0 for none.
    pub sky: [f32; 4],
    /// 128 colours from the shore down, then 128 from the shore (or the lowest land) up, at
    /// shares of the height that grow with the square.
    pub ramp: [[f32; 4]; 256],
}

type Stops = &'static [(f32, [u8; 3])];

/// Metres: used as they are where there is a shore, else spread over the heights.
const SEA: Stops = &[
    (0.0, [180, 215, 230]),
    (50.0, [164, 204, 224]),
    (250.0, [133, 180, 210]),
    (1200.0, [88, 141, 187]),
    (2600.0, [56, 107, 162]),
    (4000.0, [37, 80, 136]),
    (5500.0, [24, 56, 107]),
    (7500.0, [15, 34, 74]),
    (11_000.0, [9, 18, 46]),
];
const LAND: Stops = &[
    (0.0, [88, 126, 88]),
    (120.0, [112, 146, 100]),
    (350.0, [152, 172, 119]),
    (700.0, [190, 194, 142]),
    (1200.0, [207, 187, 136]),
    (2000.0, [189, 150, 106]),
    (3000.0, [158, 118, 91]),
    (4200.0, [170, 146, 131]),
    (5200.0, [214, 206, 200]),
    (6500.0, [248, 247, 246]),
];
const MOON: Stops = &[
    (0.0, [70, 69, 70]),
    (1.0, [104, 101, 98]),
    (2.0, [140, 135, 128]),
    (3.0, [184, 177, 167]),
    (4.0, [236, 230, 218]),
];
const MARS: Stops = &[
    (0.0, [88, 44, 38]),
    (1.0, [124, 60, 42]),
    (2.0, [158, 80, 50]),
    (3.0, [188, 112, 68]),
    (4.0, [216, 156, 106]),
    (5.0, [246, 229, 207]),
];
const OTHER: Stops =
    &[(0.0, [38, 34, 84]), (1.0, [45, 84, 128]), (2.0, [62, 137, 132]), (3.0, [149, 182, 113]), (4.0, [244, 226, 170])];

impl Style {
    /// The look that suits a body. `heights_m` are heights from all over it: they say whether
    /// there is a shore, and over what the tints are spread where there is none.
    #[must_use]
    pub fn of(body: &Body, heights_m: &[f32]) -> Self {
        let (stops, earth) = match body {
            Body::Plane { .. } => (LAND, true),
            Body::Ellipsoid { name, .. } => match name.as_str() {
                "earth" => (LAND, true),
                "moon" => (MOON, false),
                "mars" => (MARS, false),
                _ => (OTHER, false),
            },
        };
        let [low_m, high_m] = spread(heights_m);
        let shore = earth && heights_m.iter().any(|&h| h < 0.0) && heights_m.iter().any(|&h| h >= 0.0);
        let sky = match body {
            Body::Ellipsoid { name, .. } if name == "earth" => [0.20, 0.42, 0.92, 8_000.0],
            Body::Ellipsoid { name, .. } if name == "mars" => [0.55, 0.34, 0.22, 11_000.0],
            Body::Plane { .. } => [0.30, 0.46, 0.72, 8_000.0],
            Body::Ellipsoid { .. } => [0.0; 4],
        };
        let airless = sky[3] == 0.0;
        let mut style = Self {
            overlay: 0,
            shadow: 0,
            sea: u32::from(shore),
            air: 0.0,
            low_m: if shore { -11_000.0 } else { low_m },
            high_m: if shore { 6500.0 } else { high_m },
            ambient: if airless { 0.05 } else { 0.34 },
            exaggeration_from_m: 150.0,
            dark: if airless { 0.02 } else { 0.1 },
            bright: if airless { 0.02 } else { 0.22 },
            padding: [0; 2],
            sun_colour: if airless { [1.35, 1.32, 1.26, 0.0] } else { [1.12, 1.05, 0.93, 0.0] },
            shade_colour: if airless { [1.0, 1.0, 1.0, 0.0] } else { [0.74, 0.88, 1.16, 0.0] },
            sky,
            ramp: [[0.0; 4]; 256],
        };
        for k in 0..128u8 {
            let share = (f32::from(k) / 127.0).powi(2);
            let k = usize::from(k);
            style.ramp[k] = colour(SEA, share);
            style.ramp[128 + k] = colour(stops, share);
        }
        style
    }
}

/// The heights between which all but the outermost 0.2 % lie.
fn spread(heights_m: &[f32]) -> [f32; 2] {
    let mut heights: Vec<f32> = heights_m.iter().copied().filter(|h| h.is_finite()).collect();
    if heights.is_empty() {
        return [0.0, 1.0];
    }
    heights.sort_by(f32::total_cmp);
    let at = |share: f32| heights[((heights.len() - 1) as f32 * share) as usize];
    let (low, high) = (at(0.002), at(0.998));
    [low, high.max(low + 1e-3)]
}

/// Colour at a share of a ramp's length, linear light.
fn colour(stops: Stops, share: f32) -> [f32; 4] {
    let end = stops.last().map_or(1.0, |stop| stop.0);
    let at = share * end;
    let above = stops.iter().position(|stop| stop.0 >= at).unwrap_or(stops.len() - 1).max(1);
    let ((low, from), (high, to)) = (stops[above - 1], stops[above]);
    let share = (at - low) / (high - low);
    let channel = |k: usize| {
        let c = (f32::from(from[k]) + (f32::from(to[k]) - f32::from(from[k])) * share) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    [channel(0), channel(1), channel(2), 0.0]
}

#[cfg(test)]
mod tests {
    use super::super::light::{tint, to_srgb};
    use super::*;

    fn bytes(style: &Style, height_m: f32) -> [u8; 3] {
        to_srgb(tint(style, height_m)).map(|c| (c * 255.0).round() as u8)
    }

    #[test]
    fn the_shoreline_is_a_step() {
        let style = Style::of(&Body::earth(), &[-4000.0, 0.0, 3000.0]);
        let ([r, g, b], sea) = (bytes(&style, 0.0), bytes(&style, -0.1));
        assert!(g > r && g > b, "land is green");
        assert!(sea[2] > sea[1] && sea[1] > sea[0], "sea is blue");
        let [r, g, b] = bytes(&style, 9000.0);
        assert!(r > 240 && g > 240 && b > 240, "peaks are white");
        let deep = bytes(&style, -4000.0);
        assert!(deep.iter().zip([37u8, 80, 136]).all(|(&a, b)| a.abs_diff(b) < 4), "{deep:?}");
    }

    #[test]
    fn without_a_shore_tints_spread_over_the_heights() {
        let heights: Vec<f32> = (0..1000u16).map(|k| 1500.0 + f32::from(k)).collect();
        let style = Style::of(&Body::moon(), &heights);
        assert_eq!(bytes(&style, 0.0), MOON[0].1);
        assert_eq!(bytes(&style, 2499.0), MOON[4].1);
        assert_eq!(bytes(&Style::of(&Body::moon(), &[]), f32::NAN).len(), 3);
    }
}
