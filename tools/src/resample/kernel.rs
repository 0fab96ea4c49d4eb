//! One-dimensional kernels: which samples a position is made from, with which weights.

use super::axis::Axis;

/// A kernel with its choice already made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kernel {
    Nearest,
    Bilinear,
    Cubic,
    Lanczos,
    /// Mean over `width` samples (any positive number), edge samples by the covered part.
    Box {
        width: f64,
    },
}

impl Kernel {
    /// Taps of every position; for a box the most that any position needs.
    #[inline]
    pub fn taps(self) -> usize {
        match self {
            Self::Nearest => 1,
            Self::Bilinear => 2,
            Self::Cubic => 4,
            Self::Lanczos => 6,
            Self::Box { width } => width.ceil() as usize + 1,
        }
    }

    /// What stands in where a tap is void: a kernel without negative weights.
    pub fn fallback(self) -> Self {
        match self {
            Self::Cubic | Self::Lanczos => Self::Bilinear,
            other => other,
        }
    }

    /// First tap of a position; those of the fallback lie within the kernel's own.
    #[inline]
    pub fn start(self, axis: &Axis, u: f64) -> i64 {
        match self {
            Self::Nearest => axis.home(u),
            Self::Bilinear => floor(u),
            Self::Cubic => floor(u) - 1,
            Self::Lanczos => floor(u) - 2,
            Self::Box { width } => floor((u - 0.5 * width).max(axis.reach()[0]) + 0.5),
        }
    }

    /// Writes the weights of a position, which sum to 1; `weights` is as long as [`Kernel::taps`].
    #[inline]
    pub fn weigh(self, axis: &Axis, u: f64, weights: &mut [f64]) {
        let f = u - floor(u) as f64;
        match self {
            Self::Nearest => weights[0] = 1.0,
            Self::Bilinear => weights.copy_from_slice(&[1.0 - f, f]),
            Self::Cubic => weights.copy_from_slice(&keys(f)),
            Self::Lanczos => weights.copy_from_slice(&lanczos3(f)),
            Self::Box { width } => {
                let [from, to] = axis.reach();
                let (from, to) = ((u - 0.5 * width).max(from), (u + 0.5 * width).min(to));
                let first = self.start(axis, u) as f64;
                let mut sum = 0.0;
                for (tap, weight) in weights.iter_mut().enumerate() {
                    let centre = first + tap as f64;
                    *weight = ((centre + 0.5).min(to) - (centre - 0.5).max(from)).max(0.0);
                    sum += *weight;
                }
                weights.iter_mut().for_each(|weight| *weight /= sum);
            }
        }
    }
}

/// The largest integer not above u, |u| < 2^63, without a call into the C library.
#[inline]
pub(crate) fn floor(u: f64) -> i64 {
    let cut = u as i64;
    cut - i64::from(cut as f64 > u)
}

/// Keys (1981) "Cubic convolution interpolation", a = -1/2, for taps -1, 0, 1, 2.
pub(crate) fn keys(f: f64) -> [f64; 4] {
    [
        f * (-0.5 + f * (1.0 - 0.5 * f)),
        1.0 + f * f * (1.5 * f - 2.5),
        f * (0.5 + f * (2.0 - 1.5 * f)),
        f * f * (0.5 * f - 0.5),
    ]
}

/// Sinc windowed by a sinc over three lobes, taps -2 to 3, normalised to sum 1.
pub(crate) fn lanczos3(f: f64) -> [f64; 6] {
    use std::f64::consts::PI;
    if f == 0.0 {
        return [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    }
    let mut weights = std::array::from_fn(|tap| {
        let x = PI * (f + 2.0 - tap as f64);
        3.0 * x.sin() * (x / 3.0).sin() / (x * x)
    });
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> Axis {
        Axis::latitude(20, 0.0, 1.0, [-0.5, 19.5], false)
    }

    fn weights(kernel: Kernel, u: f64) -> (i64, Vec<f64>) {
        let mut weights = vec![f64::NAN; kernel.taps()];
        kernel.weigh(&axis(), u, &mut weights);
        (kernel.start(&axis(), u), weights)
    }

    const ALL: [Kernel; 6] = [
        Kernel::Nearest,
        Kernel::Bilinear,
        Kernel::Cubic,
        Kernel::Lanczos,
        Kernel::Box { width: 0.7 },
        Kernel::Box { width: 3.4 },
    ];

    #[test]
    fn weights_sum_to_one_and_hold_the_fallback() {
        for kernel in ALL {
            for step in -5..=195 {
                let u = f64::from(step) * 0.1;
                let (start, w) = weights(kernel, u);
                assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{kernel:?} at {u}");
                let (inner, inner_w) = weights(kernel.fallback(), u);
                assert!(inner >= start && inner + inner_w.len() as i64 <= start + w.len() as i64);
                let home = axis().home(u);
                assert!(home >= start && home < start + w.len() as i64, "{kernel:?} at {u}");
            }
        }
    }

    #[test]
    fn cubic_reproduces_parabolas_and_bilinear_lines() {
        for f in [0.0, 0.25, 0.5, 0.9] {
            let u = 7.0 + f;
            let (start, w) = weights(Kernel::Cubic, u);
            let value: f64 = w.iter().zip(start..).map(|(w, x)| w * (x * x) as f64).sum();
            assert!((value - u * u).abs() < 1e-12);
            let (start, w) = weights(Kernel::Bilinear, u);
            let value: f64 = w.iter().zip(start..).map(|(w, x)| w * x as f64).sum();
            assert!((value - u).abs() < 1e-12);
        }
    }

    #[test]
    fn floors() {
        for u in [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 2.999_999_9, -2.000_000_1, 1e15 + 0.5, -1e15 - 0.5] {
            assert_eq!(floor(u), u.floor() as i64, "{u}");
        }
    }

    #[test]
    fn boxes_count_parts_of_samples() {
        let (start, w) = weights(Kernel::Box { width: 2.0 }, 5.0);
        assert_eq!((start, w), (4, vec![0.25, 0.5, 0.25]));
        let (start, w) = weights(Kernel::Box { width: 2.0 }, 0.0);
        assert_eq!(start, 0);
        assert!((w[0] - 2.0 / 3.0).abs() < 1e-15 && (w[1] - 1.0 / 3.0).abs() < 1e-15);
        let (start, w) = weights(Kernel::Box { width: 2.0 }, 5.5);
        assert_eq!((start, w), (5, vec![0.5, 0.5, 0.0]));
    }
}
