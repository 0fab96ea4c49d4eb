//! Hypsometric tints: a colour for each height.

use relief_formats::body::Body;

use super::colour::{Linear, Ramp};
use super::field::percentiles;

/// Which family of tints suits the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tint {
    /// Blues below 0 m; greens, browns and white above.
    Earth,
    /// Warm greys over the data's range.
    Moon,
    /// Rust over the data's range.
    Mars,
    /// A sequence of even lightness over the data's range.
    Other,
}

impl Tint {
    /// By the body's name; a plane gets the Earth's tints.
    #[must_use]
    pub fn of(body: &Body) -> Self {
        match body {
            Body::Plane { .. } => Self::Earth,
            Body::Ellipsoid { name, .. } => match name.as_str() {
                "earth" => Self::Earth,
                "moon" => Self::Moon,
                "mars" => Self::Mars,
                _ => Self::Other,
            },
        }
    }
}

const SEA: &[(f32, [u8; 3])] = &[
    (-11_000.0, [9, 18, 46]),
    (-7_500.0, [15, 34, 74]),
    (-5_500.0, [24, 56, 107]),
    (-4_000.0, [37, 80, 136]),
    (-2_600.0, [56, 107, 162]),
    (-1_200.0, [88, 141, 187]),
    (-250.0, [133, 180, 210]),
    (-50.0, [164, 204, 224]),
    (0.0, [180, 215, 230]),
];
const LAND: &[(f32, [u8; 3])] = &[
    (0.0, [84, 126, 82]),
    (120.0, [106, 146, 92]),
    (350.0, [148, 172, 110]),
    (700.0, [189, 194, 135]),
    (1_200.0, [206, 186, 132]),
    (2_000.0, [189, 150, 104]),
    (3_000.0, [160, 119, 90]),
    (4_200.0, [170, 146, 131]),
    (5_200.0, [214, 206, 200]),
    (6_500.0, [248, 247, 246]),
];
const MOON: &[(f32, [u8; 3])] =
    &[(0.0, [48, 47, 48]), (0.25, [88, 85, 82]), (0.5, [128, 123, 116]), (0.8, [182, 175, 164]), (1.0, [232, 226, 214])];
const MARS: &[(f32, [u8; 3])] = &[
    (0.0, [58, 27, 25]),
    (0.2, [104, 46, 31]),
    (0.45, [160, 82, 46]),
    (0.7, [201, 130, 80]),
    (0.9, [228, 182, 136]),
    (1.0, [246, 229, 207]),
];
const OTHER: &[(f32, [u8; 3])] = &[
    (0.0, [38, 34, 84]),
    (0.25, [45, 84, 128]),
    (0.5, [62, 137, 132]),
    (0.75, [149, 182, 113]),
    (1.0, [244, 226, 170]),
];

/// Colours for the heights of one raster.
pub struct Tints {
    sea: Option<Ramp>,
    land: Ramp,
    /// Position on `land` = (height - offset) scale.
    offset_m: f32,
    scale: f32,
}

impl Tints {
    /// The Earth's tints are absolute where there is a shoreline to show; a raster all above the
    /// sea spreads the land tints over its own range, as the other bodies do.
    pub fn new(tint: Tint, heights_m: &[f32]) -> Self {
        let [low, high] = percentiles(heights_m.iter().copied(), [0.002, 0.998]).unwrap_or([0.0, 1.0]);
        let minimum = heights_m.iter().copied().fold(f32::INFINITY, f32::min);
        let spread = |stops: &[(f32, [u8; 3])], span: f32| Self {
            sea: None,
            land: Ramp::new(stops),
            offset_m: low,
            scale: span / (high - low).max(f32::MIN_POSITIVE),
        };
        match tint {
            Tint::Earth if minimum >= 0.0 => spread(LAND, 5_200.0),
            Tint::Earth => Self { sea: Some(Ramp::new(SEA)), land: Ramp::new(LAND), offset_m: 0.0, scale: 1.0 },
            Tint::Moon => spread(MOON, 1.0),
            Tint::Mars => spread(MARS, 1.0),
            Tint::Other => spread(OTHER, 1.0),
        }
    }

    /// The tint of a height.
    pub fn at(&self, height_m: f32) -> Linear {
        match &self.sea {
            Some(sea) if height_m < 0.0 => sea.at(height_m),
            _ => self.land.at((height_m - self.offset_m) * self.scale),
        }
    }

    /// True for a height below a sea that is shown.
    pub fn is_sea(&self, height_m: f32) -> bool {
        self.sea.is_some() && height_m < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::colour::to_srgb;
    use super::*;

    #[test]
    fn the_shoreline_is_a_step() {
        let tints = Tints::new(Tint::Earth, &[-4000.0, 0.0, 3000.0]);
        let ([r, g, b], sea) = (to_srgb(tints.at(0.0)), to_srgb(tints.at(-0.1)));
        assert!(g > r && g > b, "land is green");
        assert!(sea[2] > sea[1] && sea[2] > sea[0], "sea is blue");
        assert!(tints.is_sea(-0.1) && !tints.is_sea(0.0) && !tints.is_sea(f32::NAN));
    }

    #[test]
    fn land_alone_spreads_over_its_range() {
        let heights: Vec<f32> = (0..1000).map(|k| 1500.0 + k as f32).collect();
        let tints = Tints::new(Tint::Earth, &heights);
        assert_eq!(to_srgb(tints.at(1500.0)), LAND[0].1);
        assert!(to_srgb(tints.at(2499.0)).iter().all(|&c| c > 190));
    }

    #[test]
    fn flat_and_void_data_have_tints() {
        for tint in [Tint::Earth, Tint::Moon, Tint::Mars, Tint::Other] {
            for heights in [&[5.0f32; 4][..], &[f32::NAN; 4], &[]] {
                assert!(Tints::new(tint, heights).at(5.0).iter().all(|c| c.is_finite()));
            }
        }
    }

    #[test]
    fn bodies_have_their_own() {
        assert_eq!(Tint::of(&Body::mars()), Tint::Mars);
        assert_eq!(Tint::of(&Body::Ellipsoid { name: "1,1".into(), a_m: 1.0, b_m: 1.0 }), Tint::Other);
    }
}
