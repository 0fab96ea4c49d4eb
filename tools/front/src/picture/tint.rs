//! Hypsometric tints: a colour for each height.

use relief_formats::body::Body;

use super::colour::{Linear, Ramp, from_srgb};
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
    (0.0, [88, 126, 88]),
    (120.0, [112, 146, 100]),
    (350.0, [152, 172, 119]),
    (700.0, [190, 194, 142]),
    (1_200.0, [207, 187, 136]),
    (2_000.0, [189, 150, 106]),
    (3_000.0, [158, 118, 91]),
    (4_200.0, [170, 146, 131]),
    (5_200.0, [214, 206, 200]),
    (6_500.0, [248, 247, 246]),
];
const MOON: &[[u8; 3]] = &[[44, 43, 44], [86, 83, 80], [128, 123, 116], [178, 171, 160], [236, 230, 218]];
const MARS: &[[u8; 3]] =
    &[[58, 27, 25], [104, 46, 31], [150, 72, 42], [186, 108, 64], [216, 156, 106], [246, 229, 207]];
const OTHER: &[[u8; 3]] = &[[38, 34, 84], [45, 84, 128], [62, 137, 132], [149, 182, 113], [244, 226, 170]];

/// Colours for the heights of one raster.
pub struct Tints {
    sea: Option<Ramp>,
    land: Ramp,
    /// What slopes in shadow and in light turn to.
    pub shadow: Linear,
    /// See `shadow`.
    pub sun: Linear,
}

impl Tints {
    /// The Earth's tints are absolute where there is a shoreline to show; a raster that lies all
    /// above or all below the sea spreads them over its own range, as the other bodies do.
    pub fn new(tint: Tint, heights_m: &[f32]) -> Self {
        let [low, high] = percentiles(heights_m.iter().copied(), [0.002, 0.998]).unwrap_or([0.0, 1.0]);
        let spread = |colours: &[[u8; 3]]| {
            let step = (high - low).max(1e-3) / (colours.len() - 1) as f32;
            Ramp::new(&colours.iter().enumerate().map(|(k, &c)| (low + step * k as f32, c)).collect::<Vec<_>>())
        };
        let spread_stops = |stops: &[(f32, [u8; 3])]| spread(&stops.iter().map(|stop| stop.1).collect::<Vec<_>>());
        let dry = !heights_m.iter().any(|&h| h < 0.0);
        let drowned = !heights_m.iter().any(|&h| h >= 0.0);
        let (sea, land) = match tint {
            Tint::Earth if dry => (None, spread_stops(LAND)),
            Tint::Earth if drowned => (Some(spread_stops(SEA)), Ramp::new(LAND)),
            Tint::Earth => (Some(Ramp::new(SEA)), Ramp::new(LAND)),
            Tint::Moon => (None, spread(MOON)),
            Tint::Mars => (None, spread(MARS)),
            Tint::Other => (None, spread(OTHER)),
        };
        let (shadow, sun) = match tint {
            Tint::Earth => ([22, 26, 46], [255, 250, 232]),
            Tint::Moon => ([10, 10, 13], [255, 251, 242]),
            Tint::Mars => ([34, 8, 12], [255, 232, 206]),
            Tint::Other => ([18, 16, 46], [255, 250, 226]),
        };
        Self { sea, land, shadow: from_srgb(shadow), sun: from_srgb(sun) }
    }

    /// The tint of a height.
    pub fn at(&self, height_m: f32) -> Linear {
        match &self.sea {
            Some(sea) if height_m < 0.0 => sea.at(height_m),
            _ => self.land.at(height_m),
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
    fn a_sea_floor_alone_spreads_over_its_range() {
        let tints = Tints::new(Tint::Earth, &[-80.0, f32::NAN, -20.0]);
        assert_eq!(to_srgb(tints.at(-80.0)), SEA[0].1);
        assert!(to_srgb(tints.at(-20.0)).iter().zip(SEA[8].1).all(|(&a, b)| a.abs_diff(b) <= 1));
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
