//! Rasters of f32 with voids: smoothing and percentiles.

/// A borrowed raster and how its sides close.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    pub width: usize,
    pub height: usize,
    pub values: &'a [f32],
    /// The right edge continues at the left.
    pub wraps: bool,
}

impl Field<'_> {
    /// Nearly Gaussian smoothing: three box means of `radius` pixels each way. Voids take no part
    /// and stay voids. Radius 0 copies.
    pub fn smooth(&self, radius: usize) -> Vec<f32> {
        // Taken from one of the values, so that level ground stays level to the last bit.
        let datum = self.values.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
        let mut values: Vec<f32> = self.values.iter().map(|&v| if v.is_nan() { 0.0 } else { v - datum }).collect();
        let mut weights: Vec<f32> = self.values.iter().map(|&v| if v.is_nan() { 0.0 } else { 1.0 }).collect();
        if radius > 0 {
            for _ in 0..3 {
                for plane in [&mut values, &mut weights] {
                    self.box_rows(plane, radius);
                    self.box_columns(plane, radius);
                }
            }
        }
        for ((value, &weight), original) in values.iter_mut().zip(&weights).zip(self.values) {
            *value = if original.is_nan() { f32::NAN } else { *value / weight + datum };
        }
        values
    }

    /// Mean of 2 radius + 1 pixels along each row; beyond an open edge, the edge.
    fn box_rows(&self, plane: &mut [f32], radius: usize) {
        let width = self.width as isize;
        let column = |k: isize| if self.wraps { k.rem_euclid(width) } else { k.clamp(0, width - 1) } as usize;
        let (reach, scale) = (radius as isize, 1.0 / (2 * radius + 1) as f64);
        let mut row = vec![0.0; self.width];
        for line in plane.chunks_exact_mut(self.width) {
            row.copy_from_slice(line);
            let mut sum: f64 = (-reach..=reach).map(|k| f64::from(row[column(k)])).sum();
            for (x, out) in line.iter_mut().enumerate() {
                *out = (sum * scale) as f32;
                let x = x as isize;
                sum += f64::from(row[column(x + reach + 1)]) - f64::from(row[column(x - reach)]);
            }
        }
    }

    fn box_columns(&self, plane: &mut [f32], radius: usize) {
        let source = plane.to_vec();
        let row = |k: isize| {
            let k = k.clamp(0, self.height as isize - 1) as usize;
            &source[k * self.width..(k + 1) * self.width]
        };
        let (reach, scale) = (radius as isize, 1.0 / (2 * radius + 1) as f64);
        let mut sums = vec![0.0f64; self.width];
        for k in -reach..=reach {
            sums.iter_mut().zip(row(k)).for_each(|(sum, &v)| *sum += f64::from(v));
        }
        for (y, line) in plane.chunks_exact_mut(self.width).enumerate() {
            let y = y as isize;
            let (enters, leaves) = (row(y + reach + 1), row(y - reach));
            for (x, out) in line.iter_mut().enumerate() {
                *out = (sums[x] * scale) as f32;
                sums[x] += f64::from(enters[x]) - f64::from(leaves[x]);
            }
        }
    }
}

/// The values at shares (0 to 1) of the sorted numbers that are no NaN; none when there are none.
/// At most about 100 000 values, evenly picked, are looked at.
pub fn percentiles<const N: usize>(values: impl ExactSizeIterator<Item = f32>, shares: [f32; N]) -> Option<[f32; N]> {
    // An odd stride does not fall in step with rows of even length.
    let stride = (values.len() / 100_000) | 1;
    let mut sample: Vec<f32> = values.step_by(stride).filter(|v| !v.is_nan()).collect();
    sample.sort_unstable_by(f32::total_cmp);
    let last = sample.len().checked_sub(1)?;
    Some(shares.map(|share| sample[(share * last as f32).round() as usize]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_keeps_a_constant_and_the_voids() {
        let mut values = vec![7.5; 20 * 10];
        values[33] = f32::NAN;
        for wraps in [false, true] {
            let smooth = Field { width: 20, height: 10, values: &values, wraps }.smooth(4);
            assert!(smooth[33].is_nan());
            assert!(smooth.iter().enumerate().all(|(k, v)| k == 33 || (v - 7.5).abs() < 1e-5));
        }
    }

    #[test]
    fn smoothing_wraps_where_it_is_told() {
        let mut values = vec![0.0; 32];
        values[0] = 1.0;
        let smooth = |wraps| Field { width: 32, height: 1, values: &values, wraps }.smooth(1);
        assert!((smooth(true)[31] - smooth(true)[1]).abs() < 1e-6 && smooth(true)[31] > 0.1);
        assert!(smooth(false)[31].abs() < 1e-6);
    }

    #[test]
    fn percentiles_leave_voids_out() {
        let values = [3.0, f32::NAN, 1.0, 2.0, f32::NAN];
        assert_eq!(percentiles(values.into_iter(), [0.0, 0.5, 1.0]), Some([1.0, 2.0, 3.0]));
        assert_eq!(percentiles([f32::NAN].into_iter(), [0.5]), None);
    }
}
