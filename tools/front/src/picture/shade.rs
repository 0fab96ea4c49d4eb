//! Shading: slopes lit from several sides at several scales.
//!
//! One light leaves slopes along its azimuth flat; a weighted set around it does not (Mark 1992).
//! Smoothed copies of the heights, each exaggerated to its own relief, keep ranges and basins
//! legible where single slopes are too fine to see.

use rayon::prelude::*;

use super::field::{Field, percentiles};

/// Azimuth from north in degrees and weight of each light; all stand 45 degrees high.
const LIGHTS: [(f32, f32); 4] = [(315.0, 0.5), (270.0, 0.2), (0.0, 0.2), (225.0, 0.1)];
/// Smoothing radius in output pixels and weight of each scale.
const SCALES: [(f32, f32); 3] = [(0.0, 0.5), (1.3, 0.3), (4.0, 0.2)];
/// Slopes are exaggerated until this share of them is no steeper than 45 degrees.
const GENTLE: f32 = 0.95;
const MOST_EXAGGERATION: f32 = 200.0;

/// The light on each pixel less that on level ground, about -0.7 to 0.3; 0 on voids.
///
/// `cell_east_m` has the width of a cell for each row, `cell_north_m` its height; `kind` sorts
/// pixels into those that share an exaggeration (land and sea).
pub fn shade(
    field: Field<'_>,
    cell_east_m: &[f64],
    cell_north_m: f64,
    pixel: usize,
    kind: impl Fn(f32) -> bool + Sync,
) -> Vec<f32> {
    let lights = Lights::new();
    let scales = SCALES.par_iter().map(|&(radius, weight)| {
        let smooth = field.smooth((radius * pixel as f32).round() as usize);
        let slopes = slopes(Field { values: &smooth, ..field }, cell_east_m, cell_north_m);
        let exaggeration = [false, true].map(|wanted| {
            let steepness = slopes.iter().zip(field.values).map(|(&[east, north], &height_m)| {
                if kind(height_m) == wanted && !height_m.is_nan() { east.hypot(north) } else { f32::NAN }
            });
            let [typical] = percentiles(steepness, [GENTLE]).unwrap_or([1.0]);
            if typical > 0.0 { (1.0 / typical).min(MOST_EXAGGERATION) } else { 1.0 }
        });
        let lit = slopes.iter().zip(field.values).map(|(&[east, north], &height_m)| {
            let z = exaggeration[usize::from(kind(height_m))];
            weight * lights.on(east * z, north * z)
        });
        lit.collect::<Vec<f32>>()
    });
    // Collected first: the sum must not depend on which scale is ready.
    let scales: Vec<_> = scales.collect();
    (0..field.values.len()).map(|k| scales.iter().map(|scale| scale[k]).sum()).collect()
}

/// Directions towards the lights: east, north and weight of each.
struct Lights([[f32; 3]; LIGHTS.len()]);

impl Lights {
    fn new() -> Self {
        Self(LIGHTS.map(|(azimuth_deg, weight)| {
            let (sin, cos) = azimuth_deg.to_radians().sin_cos();
            [sin, cos, weight]
        }))
    }

    /// Light on a slope (rise eastwards, rise northwards) less that on level ground.
    fn on(&self, east: f32, north: f32) -> f32 {
        let high = std::f32::consts::FRAC_1_SQRT_2;
        let scale = high / (1.0 + east * east + north * north).sqrt();
        let each = |[sin, cos, weight]: [f32; 3]| weight * (scale * (1.0 - east * sin - north * cos)).max(0.0);
        self.0.into_iter().map(each).sum::<f32>() - high
    }
}

/// Rise eastwards and northwards by the kernel of Horn (1981); a void counts as level with the
/// pixel it touches. Near a pole cells are taken no narrower than a fifth of the widest.
fn slopes(field: Field<'_>, cell_east_m: &[f64], cell_north_m: f64) -> Vec<[f32; 2]> {
    let Field { width, height, values, wraps } = field;
    let narrowest_m = cell_east_m.iter().copied().fold(0.0, f64::max) * 0.2;
    let mut slopes = Vec::with_capacity(values.len());
    for (y, &east_m) in cell_east_m.iter().enumerate() {
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| &values[y * width..(y + 1) * width]);
        let per_east = (1.0 / (8.0 * east_m.max(narrowest_m))) as f32;
        let per_north = (1.0 / (8.0 * cell_north_m)) as f32;
        for x in 0..width {
            let here = rows[1][x];
            if here.is_nan() {
                slopes.push([0.0; 2]);
                continue;
            }
            let (west, east) = match wraps {
                true => ((x + width - 1) % width, (x + 1) % width),
                false => (x.saturating_sub(1), (x + 1).min(width - 1)),
            };
            let at = |row: usize, x: usize| if rows[row][x].is_nan() { here } else { rows[row][x] };
            let (nw, n, ne) = (at(0, west), at(0, x), at(0, east));
            let (sw, s, se) = (at(2, west), at(2, x), at(2, east));
            let rise_east = (ne + 2.0 * at(1, east) + se) - (nw + 2.0 * at(1, west) + sw);
            let rise_north = (nw + 2.0 * n + ne) - (sw + 2.0 * s + se);
            slopes.push([rise_east * per_east, rise_north * per_north]);
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(east: f32, north: f32) -> Vec<f32> {
        (0..16 * 16).map(|k| (k % 16) as f32 * east - (k / 16) as f32 * north).collect()
    }

    #[test]
    fn slopes_are_rise_over_run() {
        let values = ramp(3.0, -5.0);
        let slopes = slopes(Field { width: 16, height: 16, values: &values, wraps: false }, &[10.0; 16], 20.0);
        let [east, north] = slopes[8 * 16 + 8];
        assert!((east - 0.3).abs() < 1e-6 && (north + 0.25).abs() < 1e-6);
    }

    #[test]
    fn what_faces_north_west_is_bright() {
        let light = |east, north| {
            let values = ramp(east, north);
            shade(Field { width: 16, height: 16, values: &values, wraps: false }, &[1.0; 16], 1.0, 1, |_| false)
                [8 * 16 + 8]
        };
        // Ground that rises to the south-east faces the north-west.
        assert!(light(1.0, -1.0) > 0.1 && light(-1.0, 1.0) < -0.2);
        assert!(light(0.0, 0.0).abs() < 1e-6);
    }

    #[test]
    fn voids_are_level_and_cast_nothing() {
        let mut values = vec![100.0; 256];
        values[100] = f32::NAN;
        let light = shade(Field { width: 16, height: 16, values: &values, wraps: true }, &[1.0; 16], 1.0, 1, |_| false);
        assert!(light.iter().all(|l| l.abs() < 1e-4));
    }
}
