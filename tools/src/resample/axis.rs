//! One axis of a lon/lat raster: from an angle to sample coordinates and to stored samples.
//!
//! Sample coordinate u is 0 at the first sample's position and n - 1 at the last one's; the
//! pixel of sample p covers [p - 1/2, p + 1/2).

use super::kernel::floor;

/// How the raster goes on beyond one end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The outermost sample repeats.
    Clamp,
    /// The pole is the outer edge of the outermost pixel: sample -1 is sample 0 half a turn on.
    PoleEdge,
    /// The pole is the outermost sample itself: sample -1 is sample 1 half a turn on.
    PoleSample,
}

/// An axis in degrees.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// Stored samples.
    pub n: usize,
    /// Degrees at sample 0.
    pub first_deg: f64,
    /// Degrees from sample to sample, negative where they run south or west.
    pub step_deg: f64,
    /// Samples in a full circle, where the raster has them all.
    pub period: Option<usize>,
    /// Sample coordinates in a full circle: the period, or as near to it as the georeference says.
    pub turn: f64,
    pub low: End,
    pub high: End,
    /// Sample coordinates between which the raster says anything.
    pub extent: [f64; 2],
}

/// Slack for positions that rounding has pushed over an edge, in samples.
const SLACK: f64 = 1e-6;

impl Axis {
    /// Longitudes: wraps if the samples make up a full circle to within a hundredth of a sample.
    pub fn longitude(n: usize, first_deg: f64, step_deg: f64, extent: [f64; 2]) -> Self {
        let given = Self::meridians(n, first_deg, step_deg, extent);
        match given.period {
            Some(whole) => Self { step_deg: (360.0 / whole as f64).copysign(step_deg), turn: whole as f64, ..given },
            None => given,
        }
    }

    /// As [`Axis::longitude`], but every sample stays where the step puts it, and the seam takes
    /// what is left of the circle.
    pub fn meridians(n: usize, first_deg: f64, step_deg: f64, extent: [f64; 2]) -> Self {
        let turn = 360.0 / step_deg.abs();
        let whole = turn.round();
        let period = (turn - whole).abs() < 0.01 && n as f64 >= whole && whole >= 2.0;
        let period = period.then_some(whole as usize);
        Self { n, first_deg, step_deg, period, turn, low: End::Clamp, high: End::Clamp, extent }
    }

    /// Latitudes: reflects at a pole the raster reaches, if its columns go all round (`global`).
    pub fn latitude(n: usize, first_deg: f64, step_deg: f64, extent: [f64; 2], global: bool) -> Self {
        let end = |sample: f64, outer: f64| {
            let near_pole = |u: f64| ((first_deg + u * step_deg).abs() - 90.0).abs() < 0.01 * step_deg.abs();
            match global {
                true if near_pole(sample) => End::PoleSample,
                true if near_pole(outer) => End::PoleEdge,
                _ => End::Clamp,
            }
        };
        let last = n as f64 - 1.0;
        let (low, high) = (end(0.0, -0.5), end(last, last + 0.5));
        Self { n, first_deg, step_deg, period: None, turn: 0.0, low, high, extent }
    }

    /// Pixel-corner coordinates of a raster without known directions.
    pub fn pixels(n: usize) -> Self {
        let extent = [-0.5, n as f64 - 0.5];
        Self { n, first_deg: 0.5, step_deg: 1.0, period: None, turn: 0.0, low: End::Clamp, high: End::Clamp, extent }
    }

    /// Sample coordinate of an angle; none outside the raster.
    #[inline]
    pub fn position(&self, angle_deg: f64) -> Option<f64> {
        if self.period.is_some() {
            // First sample up to the position that repeats it.
            let u = snap((angle_deg - self.first_deg) / self.step_deg);
            let wrapped = u.rem_euclid(self.turn);
            return Some(if wrapped >= self.turn { 0.0 } else { wrapped });
        }
        let [from, to] = self.extent;
        let u = snap((angle_deg - self.first_deg) / self.step_deg);
        let inside = u >= from - SLACK && u <= to + SLACK;
        inside.then(|| u.clamp(from, to))
    }

    /// [`Axis::position`] of a longitude, which any number of full turns may be added to.
    pub fn longitude_position(&self, lon_deg: f64) -> Option<f64> {
        if self.period.is_some() {
            return self.position(lon_deg);
        }
        let middle_deg = self.first_deg + 0.5 * (self.extent[0] + self.extent[1]) * self.step_deg;
        let nearest = lon_deg - 360.0 * ((lon_deg - middle_deg) / 360.0).round();
        [0.0, -360.0, 360.0].into_iter().find_map(|turn| self.position(nearest + turn))
    }

    /// Lowest and highest angle that [`Axis::position`] has an answer for, unwrapped.
    pub fn range_deg(&self) -> [f64; 2] {
        let angle_deg = |u: f64| self.first_deg + u * self.step_deg;
        let (a, b) = (angle_deg(self.extent[0] - 2.0 * SLACK), angle_deg(self.extent[1] + 2.0 * SLACK));
        [a.min(b), a.max(b)]
    }

    /// The pixel that contains u; may be one beyond the end where the axis wraps.
    #[inline]
    pub fn home(&self, u: f64) -> i64 {
        let home = floor(u + 0.5);
        if self.period.is_some() { home } else { home.clamp(0, self.n as i64 - 1) }
    }

    /// The stored sample behind a sample index that may lie beyond the ends, and whether it is
    /// half a turn away on the other axis.
    pub fn stored(&self, index: i64) -> (usize, bool) {
        let n = self.n as i64;
        if let Some(period) = self.period {
            return (index.rem_euclid(period as i64) as usize, false);
        }
        let last = n - 1;
        let (at, turned) = match () {
            () if index < 0 => match self.low {
                End::Clamp => (0, false),
                End::PoleEdge => (-1 - index, true),
                End::PoleSample => (-index, true),
            },
            () if index > last => match self.high {
                End::Clamp => (last, false),
                End::PoleEdge => (2 * last + 1 - index, true),
                End::PoleSample => (2 * last - index, true),
            },
            () => (index, false),
        };
        (at.clamp(0, last) as usize, turned)
    }

    /// Samples between which a mean may reach: all that exist, and those beyond a pole or a seam.
    pub fn reach(&self) -> [f64; 2] {
        let end = |end: End, at: f64, beyond: f64| {
            if end == End::Clamp && self.period.is_none() { at } else { beyond }
        };
        [end(self.low, -0.5, f64::NEG_INFINITY), end(self.high, self.n as f64 - 0.5, f64::INFINITY)]
    }
}

/// Takes away the rounding that would make ties between two pixels a matter of chance.
#[inline]
fn snap(u: f64) -> f64 {
    // The nearest integer below 2^51, without a call into the C library; ties are far from snapping.
    const INTEGERS: f64 = 6_755_399_441_055_744.0;
    let halves = (2.0 * u + INTEGERS) - INTEGERS;
    if (2.0 * u - halves).abs() < SLACK { 0.5 * halves } else { u }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(n: usize, first_deg: f64, step_deg: f64) -> Axis {
        Axis::longitude(n, first_deg, step_deg, [-0.5, n as f64 - 0.5])
    }

    #[test]
    fn gridline_column_repeats() {
        // 0..360 with a repeated column, edges at -0.05 and 360.05.
        let etopo = cells(3601, 0.0, 0.1);
        assert_eq!(etopo.period, Some(3600));
        assert_eq!(etopo.longitude_position(-180.0), Some(1800.0));
        assert_eq!(etopo.longitude_position(-0.1), Some(3599.0));
        assert_eq!((etopo.stored(3600), etopo.stored(-1)), ((0, false), (3599, false)));
    }

    #[test]
    fn regional_longitudes_find_their_turn() {
        let fiji = cells(216, 172.0, 1.0 / 12.0);
        assert_eq!(fiji.period, None);
        assert_eq!(fiji.longitude_position(-180.0), Some(96.0));
        assert_eq!(fiji.longitude_position(179.0), Some(84.0));
        assert_eq!(fiji.longitude_position(0.0), None);
        assert_eq!(fiji.longitude_position(171.9), None);
    }

    #[test]
    fn rows_reflect_at_poles() {
        let cell = Axis::latitude(4, 67.5, -45.0, [-0.5, 3.5], true);
        assert_eq!((cell.low, cell.high), (End::PoleEdge, End::PoleEdge));
        assert_eq!((cell.stored(-1), cell.stored(4), cell.stored(5)), ((0, true), (3, true), (2, true)));
        let node = Axis::latitude(5, -90.0, 45.0, [-0.5, 4.5], true);
        assert_eq!((node.low, node.high), (End::PoleSample, End::PoleSample));
        assert_eq!((node.stored(-1), node.stored(5)), ((1, true), (3, true)));
        let partial = Axis::latitude(5, 60.0, -1.0, [-0.5, 4.5], true);
        assert_eq!((partial.low, partial.stored(-3)), (End::Clamp, (0, false)));
    }

    #[test]
    fn rounding_does_not_move_samples() {
        let axis = cells(1000, 40.0 + 0.5 / 1200.0, 1.0 / 1200.0);
        for i in 0..1000 {
            let lon = 40.0 + (f64::from(i) + 0.5) / 1200.0;
            assert_eq!(axis.longitude_position(lon), Some(f64::from(i)));
        }
        assert!(axis.longitude_position(40.0).is_some());
    }
}
