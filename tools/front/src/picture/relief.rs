//! Hypsometric tints under shading: the picture of a planet.

use rayon::prelude::*;

use super::colour::{Linear, from_srgb, mix, to_srgb};
use super::field::Field;
use super::shade::shade;
use super::tint::{Tint, Tints};
use super::{PictureError, RgbImage, check_size};

/// What to draw.
#[derive(Clone, Copy, Debug)]
pub struct PictureInput<'a> {
    /// Columns of the raster.
    pub width: usize,
    /// Rows of the raster.
    pub height: usize,
    /// Heights in metres, row 0 in the north; NaN is a void.
    pub heights_m: &'a [f32],
    /// Width of a cell in metres for each row (it shrinks with latitude).
    pub cell_east_m: &'a [f64],
    /// Height of a cell in metres.
    pub cell_north_m: f64,
    /// The right edge continues at the left.
    pub wraps: bool,
    /// The family of colours.
    pub tint: Tint,
    /// Raster pixels along the side of an output pixel, at least 1. Two give a shoreline that is
    /// crisp and smooth.
    pub supersample: usize,
}

/// Draws a shaded relief of `width / supersample` x `height / supersample` pixels.
///
/// The vertical exaggeration follows from the data: at each of three scales the steepest slopes
/// but 5 % come to 45 degrees. Voids are a hatched grey.
///
/// # Errors
/// Slices that do not match the size, or a size that is no multiple of `supersample`.
pub fn shaded_relief(input: &PictureInput<'_>) -> Result<RgbImage, PictureError> {
    let PictureInput { width, height, heights_m, cell_east_m, supersample, .. } = *input;
    check_size(width, height, supersample, heights_m.len())?;
    if cell_east_m.len() != height {
        return Err(PictureError::Length { what: "cell_east_m", length: cell_east_m.len(), expected: height });
    }
    let field = Field { width, height, values: heights_m, wraps: input.wraps };
    let tints = Tints::new(input.tint, heights_m);
    let light = shade(field, cell_east_m, input.cell_north_m, supersample, |h| tints.is_sea(h));
    let painter = Painter { field, tints, light, supersample };
    let share = 1.0 / (supersample * supersample) as f32;
    let (columns, rows) = (width / supersample, height / supersample);
    let mut pixels = vec![[0; 3]; columns * rows];
    pixels.par_chunks_exact_mut(columns).enumerate().for_each(|(row, line)| {
        for (column, pixel) in line.iter_mut().enumerate() {
            let mut sum = [0.0; 3];
            for y in row * supersample..(row + 1) * supersample {
                for x in column * supersample..(column + 1) * supersample {
                    let colour = painter.colour(x, y);
                    sum = [sum[0] + colour[0], sum[1] + colour[1], sum[2] + colour[2]];
                }
            }
            *pixel = to_srgb(sum.map(|c| c * share));
        }
    });
    Ok(RgbImage { width: columns, height: rows, pixels })
}

/// How far light and shadow reach: on land, at sea.
const BRIGHTEN: [f32; 2] = [0.95, 0.38];
const DARKEN: [f32; 2] = [1.45, 0.65];
/// Share of light that water loses where it meets land.
const SHORE: f32 = 0.45;
const VOID: [[u8; 3]; 2] = [[186, 186, 184], [170, 170, 169]];

struct Painter<'a> {
    field: Field<'a>,
    tints: Tints,
    light: Vec<f32>,
    supersample: usize,
}

impl Painter<'_> {
    fn colour(&self, x: usize, y: usize) -> Linear {
        let at = y * self.field.width + x;
        let height_m = self.field.values[at];
        if height_m.is_nan() {
            let stripe = (x + y) / self.supersample % 8 < 2;
            return from_srgb(VOID[usize::from(stripe)]);
        }
        let sea = self.tints.is_sea(height_m);
        let mut colour = self.tints.at(height_m);
        if sea && self.touches_land(x, y) {
            colour = colour.map(|c| c * (1.0 - SHORE));
        }
        let light = self.light[at];
        if light < 0.0 {
            let share = (-light * DARKEN[usize::from(sea)]).min(0.9);
            mix(colour, self.tints.shadow, share)
        } else {
            // Mostly more of the same colour: a dark tint mixed with the sun's turns grey.
            let share = light * BRIGHTEN[usize::from(sea)];
            mix(colour.map(|c| c * (1.0 + 1.5 * share)), self.tints.sun, (0.5 * share).min(0.9))
        }
    }

    fn touches_land(&self, x: usize, y: usize) -> bool {
        let Field { width, height, values, wraps } = self.field;
        let left = if x > 0 {
            x - 1
        } else if wraps {
            width - 1
        } else {
            x
        };
        let right = if x + 1 < width {
            x + 1
        } else if wraps {
            0
        } else {
            x
        };
        let neighbours = [(left, y), (right, y), (x, y.saturating_sub(1)), (x, (y + 1).min(height - 1))];
        neighbours.iter().any(|&(x, y)| values[y * width + x] >= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input<'a>(heights_m: &'a [f32], cells: &'a [f64]) -> PictureInput<'a> {
        let height = cells.len();
        PictureInput {
            width: heights_m.len() / height,
            height,
            heights_m,
            cell_east_m: cells,
            cell_north_m: 1000.0,
            wraps: true,
            tint: Tint::Earth,
            supersample: 2,
        }
    }

    #[test]
    fn sea_is_blue_land_is_green_and_a_void_is_grey() {
        let mut heights: Vec<f32> = (0..64 * 32).map(|k| if k % 64 < 32 { -3000.0 } else { 100.0 }).collect();
        for row in 8..16 {
            heights[row * 64 + 40..row * 64 + 52].fill(f32::NAN);
        }
        let image = shaded_relief(&input(&heights, &[1000.0; 32])).unwrap();
        assert_eq!((image.width, image.height, image.pixels.len()), (32, 16, 512));
        let [r, g, b] = image.pixels[8 * 32 + 8];
        assert!(b > g && g > r, "sea {r} {g} {b}");
        let [r, g, b] = image.pixels[12 * 32 + 24];
        assert!(g > r && g > b, "land {r} {g} {b}");
        let voids = &image.pixels[6 * 32 + 20..6 * 32 + 26];
        assert!(voids.iter().all(|&[r, g, b]| r.abs_diff(g) < 3 && g.abs_diff(b) < 4));
        assert!(voids.iter().any(|p| p != &voids[0]), "hatched");
    }

    #[test]
    fn slices_must_fit() {
        let heights = vec![0.0; 64];
        let good = input(&heights, &[1.0; 8]);
        assert!(shaded_relief(&good).is_ok());
        assert!(shaded_relief(&PictureInput { supersample: 3, ..good }).is_err());
        assert!(shaded_relief(&PictureInput { supersample: 0, ..good }).is_err());
        assert!(shaded_relief(&PictureInput { width: 10, ..good }).is_err());
        assert!(shaded_relief(&PictureInput { cell_east_m: &[1.0; 7], ..good }).is_err());
    }

    #[test]
    fn hard_values_draw_something() {
        for value in [f32::NAN, 0.0, f32::MAX, f32::MIN, f32::INFINITY] {
            let mut heights = vec![value; 64];
            heights[9] = 3.0;
            for tint in [Tint::Earth, Tint::Moon, Tint::Mars, Tint::Other] {
                assert!(shaded_relief(&PictureInput { tint, ..input(&heights, &[1.0; 8]) }).is_ok());
            }
        }
    }
}
