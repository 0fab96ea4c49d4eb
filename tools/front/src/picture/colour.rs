//! Colours: sRGB in and out, light in linear values, ramps in Oklab where equal steps look equal.

/// Linear-light red, green, blue, 0 to 1.
pub type Linear = [f32; 3];

/// sRGB 0..=255 to linear light (IEC 61966-2-1).
pub fn from_srgb(rgb: [u8; 3]) -> Linear {
    rgb.map(|c| {
        let c = f32::from(c) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

/// Linear light to sRGB 0..=255, out-of-range values clamped.
pub fn to_srgb(rgb: Linear) -> [u8; 3] {
    rgb.map(|c| {
        let c = c.clamp(0.0, 1.0);
        let c = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (c * 255.0).round() as u8
    })
}

/// A blend of two colours in linear light, `share` of the second.
pub fn mix(a: Linear, b: Linear, share: f32) -> Linear {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}

/// Linear light to Oklab (Ottosson 2020).
fn to_oklab([r, g, b]: Linear) -> [f32; 3] {
    let l = (0.412_221_47 * r + 0.536_332_54 * g + 0.051_445_995 * b).cbrt();
    let m = (0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b).cbrt();
    let s = (0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b).cbrt();
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

fn from_oklab([lightness, a, b]: [f32; 3]) -> Linear {
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
}

/// A ramp through colours at rising positions, tabulated.
pub struct Ramp {
    low: f32,
    scale: f32,
    table: Vec<Linear>,
}

impl Ramp {
    const STEPS: usize = 4096;

    /// `stops`: position and sRGB colour, positions rising, at least two.
    pub fn new(stops: &[(f32, [u8; 3])]) -> Self {
        let (low, high) = stops.first().zip(stops.last()).map_or((0.0, 1.0), |(a, b)| (a.0, b.0));
        let colour = |position: f32| {
            let pair = stops.windows(2).find(|pair| position <= pair[1].0).or(stops.windows(2).last())?;
            let share = ((position - pair[0].0) / (pair[1].0 - pair[0].0)).clamp(0.0, 1.0);
            Some(from_oklab(mix(to_oklab(from_srgb(pair[0].1)), to_oklab(from_srgb(pair[1].1)), share)))
        };
        let at = |k: usize| low + (high - low) * k as f32 / (Self::STEPS - 1) as f32;
        let table = (0..Self::STEPS).map(|k| colour(at(k)).unwrap_or_default()).collect();
        Self { low, scale: (Self::STEPS - 1) as f32 / (high - low), table }
    }

    /// The colour at a position; beyond the ends, the ends.
    pub fn at(&self, position: f32) -> Linear {
        let k = ((position - self.low) * self.scale).clamp(0.0, (Self::STEPS - 1) as f32); // NaN becomes 0
        self.table[k.round() as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_and_oklab_come_back() {
        for rgb in [[0, 0, 0], [255, 255, 255], [8, 20, 52], [200, 100, 50], [1, 254, 77]] {
            assert_eq!(to_srgb(from_srgb(rgb)), rgb);
            assert_eq!(to_srgb(from_oklab(to_oklab(from_srgb(rgb)))), rgb);
        }
        assert_eq!(to_srgb([-1.0, 0.5, 9.0]), [0, 188, 255]);
    }

    #[test]
    fn a_ramp_passes_through_its_stops() {
        let ramp = Ramp::new(&[(-10.0, [10, 20, 30]), (0.0, [200, 40, 90]), (30.0, [255, 255, 255])]);
        assert_eq!(to_srgb(ramp.at(-10.0)), [10, 20, 30]);
        assert_eq!(to_srgb(ramp.at(-99.0)), [10, 20, 30]);
        assert_eq!(to_srgb(ramp.at(f32::INFINITY)), [255, 255, 255]);
        let middle = to_srgb(ramp.at(0.0));
        assert!(middle.iter().zip([200u8, 40, 90]).all(|(&a, b)| a.abs_diff(b) <= 1), "{middle:?}");
        assert_eq!(to_srgb(ramp.at(f32::NAN)), [10, 20, 30]);
    }
}
