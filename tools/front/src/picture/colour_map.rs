//! Colour maps for planes that are no heights: deviations, bounds, differences.

use super::colour::{Ramp, from_srgb, mix, to_srgb};
use super::field::percentiles;
use super::{PictureError, RgbImage, check_size};

/// How numbers become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark violet to pale yellow, lightness rising evenly from the least to the largest value.
    Sequential,
    /// Blue below 0, near white at 0, red above, the same distance both ways.
    Signed,
}

/// What to draw.
#[derive(Clone, Copy, Debug)]
pub struct ColourMapInput<'a> {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Values, row 0 in the north; NaN is a void.
    pub values: &'a [f32],
    /// How to colour them.
    pub map: ColourMap,
    /// Values of the two ends; none takes them from the data, leaving out the outermost 0.1 %.
    pub range: Option<[f32; 2]>,
    /// Adds a bar below the picture with a tick at each tenth of the range.
    pub legend: bool,
}

const SEQUENTIAL: &[(f32, [u8; 3])] = &[
    (0.0, [30, 20, 62]),
    (0.2, [75, 38, 110]),
    (0.4, [140, 56, 118]),
    (0.6, [204, 86, 100]),
    (0.8, [241, 146, 98]),
    (1.0, [252, 236, 178]),
];
const SIGNED: &[(f32, [u8; 3])] = &[
    (0.0, [18, 52, 110]),
    (0.2, [48, 108, 172]),
    (0.4, [160, 197, 222]),
    (0.5, [246, 246, 244]),
    (0.6, [242, 186, 158]),
    (0.8, [196, 72, 64]),
    (1.0, [110, 18, 40]),
];
const VOID: [[u8; 3]; 2] = [[186, 186, 184], [170, 170, 169]];
const PAPER: [u8; 3] = [250, 250, 249];
const INK: [u8; 3] = [60, 60, 62];
const BAR_TOP: usize = 8;
const BAR_HEIGHT: usize = 12;
const LEGEND_HEIGHT: usize = BAR_TOP + BAR_HEIGHT + 14;

/// Draws a plane; the second value is the range from one end of the colours to the other.
/// With a legend the picture is 34 pixels higher than the raster.
///
/// # Errors
/// Values that do not match the size.
pub fn colour_map(input: &ColourMapInput<'_>) -> Result<(RgbImage, [f32; 2]), PictureError> {
    let ColourMapInput { width, height, values, map, .. } = *input;
    check_size(width, height, 1, values.len())?;
    let range = input.range.unwrap_or_else(|| data_range(values, map));
    let ramp = Ramp::new(match map {
        ColourMap::Sequential => SEQUENTIAL,
        ColourMap::Signed => SIGNED,
    });
    let scale = if range[1] > range[0] { 1.0 / (range[1] - range[0]) } else { 0.0 };
    // A range without extent is its middle.
    let share = |value: f32| if scale > 0.0 { (value - range[0]) * scale } else { 0.5 };
    let mut pixels = Vec::with_capacity(width * (height + LEGEND_HEIGHT));
    for (k, &value) in values.iter().enumerate() {
        pixels.push(if value.is_nan() {
            VOID[usize::from((k % width + k / width) % 8 < 2)]
        } else {
            to_srgb(ramp.at(share(value)))
        });
    }
    let mut image = RgbImage { width, height, pixels };
    if input.legend {
        add_legend(&mut image, &ramp);
    }
    Ok((image, range))
}

fn data_range(values: &[f32], map: ColourMap) -> [f32; 2] {
    let [low, high] = percentiles(values.iter().copied(), [0.001, 0.999]).unwrap_or([0.0, 0.0]);
    match map {
        ColourMap::Sequential => [low, high],
        ColourMap::Signed => {
            let reach = low.abs().max(high.abs());
            [-reach, reach]
        }
    }
}

/// A bar of the middle half of the width, ticks below it: long ones at the ends and the middle.
fn add_legend(image: &mut RgbImage, ramp: &Ramp) {
    let (left, right) = (image.width / 4, image.width - image.width / 4);
    let last = right.saturating_sub(left + 1).max(1);
    for y in 0..LEGEND_HEIGHT {
        for x in 0..image.width {
            let on_bar = (left..right).contains(&x);
            let below = y.saturating_sub(BAR_TOP + BAR_HEIGHT);
            let tenth = (0..=10).find(|k| on_bar && x - left == k * last / 10);
            let long = if tenth.is_some_and(|k| k % 5 == 0) { 7 } else { 4 };
            image.pixels.push(if on_bar && (BAR_TOP..BAR_TOP + BAR_HEIGHT).contains(&y) {
                to_srgb(ramp.at((x - left) as f32 / last as f32))
            } else if tenth.is_some() && (1..=long).contains(&below) {
                to_srgb(mix(from_srgb(PAPER), from_srgb(INK), 0.85))
            } else {
                PAPER
            });
        }
    }
    image.height += LEGEND_HEIGHT;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(values: &[f32], map: ColourMap) -> (RgbImage, [f32; 2]) {
        let input = ColourMapInput { width: values.len(), height: 1, values, map, range: None, legend: false };
        colour_map(&input).unwrap()
    }

    #[test]
    fn signed_is_centred_on_zero() {
        let (image, range) = draw(&[-2.0, 0.0, 8.0, f32::NAN], ColourMap::Signed);
        assert_eq!(range, [-8.0, 8.0]);
        let middle = image.pixels[1];
        assert!(middle.iter().all(|&c| c > 240), "{middle:?}");
        assert!(image.pixels[0][2] > image.pixels[0][0], "below is blue");
        assert_eq!(image.pixels[2], [110, 18, 40]);
        assert!(VOID.contains(&image.pixels[3]));
    }

    #[test]
    fn sequential_grows_lighter() {
        let values: Vec<f32> = (0..50).map(|k| k as f32).collect();
        let (image, range) = draw(&values, ColourMap::Sequential);
        assert_eq!(range, [0.0, 49.0]);
        let lightness = |p: &[u8; 3]| 2 * u32::from(p[0]) + 7 * u32::from(p[1]) + u32::from(p[2]);
        assert!(image.pixels.windows(2).all(|pair| lightness(&pair[1]) > lightness(&pair[0])));
    }

    #[test]
    fn a_range_without_extent_is_the_middle() {
        let (image, _) = draw(&[0.0; 9], ColourMap::Signed);
        assert!(image.pixels.iter().all(|p| p.iter().all(|&c| c > 240)));
        assert_eq!(draw(&[f32::NAN; 3], ColourMap::Sequential).1, [0.0, 0.0]);
    }

    #[test]
    fn the_legend_spans_the_colours() {
        let values = [0.0; 400];
        for (width, height) in [(40, 10), (2, 200), (1, 400)] {
            let input = ColourMapInput {
                width,
                height,
                values: &values,
                map: ColourMap::Sequential,
                range: Some([0.0, 1.0]),
                legend: true,
            };
            let (image, _) = colour_map(&input).unwrap();
            assert_eq!((image.height, image.pixels.len()), (height + 34, width * (height + 34)));
            let bar = &image.pixels[(height + BAR_TOP) * width..][..width];
            assert_eq!(bar[width / 4], SEQUENTIAL[0].1);
        }
    }
}
