//! Which of the measured cases is worth recommending, by rules that the page states.

use super::codecs::Codec;
use super::measure::Measured;

/// Share of the error at the samples that rounding may have.
const SHARE: f64 = 0.01;
/// Errors below this are none, metres.
const NONE_M: f64 = 1e-6;

/// The coarsest step whose rounding (RMS at the nodes) is at most a hundredth of the RMS error at
/// the samples, or nothing at all; none where not even the finest is that good. `steps` run from
/// fine to coarse.
#[must_use]
pub fn step(steps: &[Measured]) -> Option<usize> {
    let limit_m = (SHARE * steps.first()?.at_samples.rms_m()).max(NONE_M);
    steps.iter().take_while(|measured| measured.at_nodes.rms_m() <= limit_m).count().checked_sub(1)
}

/// The kernel with the least RMS error at the samples.
#[must_use]
pub fn kernel(kernels: &[Measured]) -> Option<usize> {
    least(kernels, |measured| measured.at_samples.rms_m())
}

/// The way that codes heights alone into the fewest bytes.
#[must_use]
pub fn codec(codecs: &[Codec]) -> Option<usize> {
    least(codecs, |codec| if codec.heights_only { codec.bytes as f64 } else { f64::INFINITY })
}

fn least<T>(items: &[T], cost: impl Fn(&T) -> f64) -> Option<usize> {
    (0..items.len()).min_by(|&a, &b| cost(&items[a]).total_cmp(&cost(&items[b])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Case, Errors};
    use crate::source::Resample;

    fn case(step_exponent: i8, node_error_m: f64, sample_error_m: f64) -> Measured {
        let (mut at_nodes, mut at_samples) = (Errors::default(), Errors::default());
        at_nodes.add(node_error_m);
        at_samples.add(sample_error_m);
        Measured {
            case: Case { step_exponent, resample: Resample::Auto },
            file_bytes: 1000,
            plane_bytes: [100; 5],
            nodes: 65_536,
            at_nodes,
            at_samples,
            encode_s: 1.0,
            decode_s: 0.1,
        }
    }

    #[test]
    fn the_coarsest_step_that_costs_nothing() {
        let steps = [case(-2, 0.07, 10.0), case(0, 0.1, 9.9), case(1, 0.2, 10.1)];
        assert_eq!(step(&steps), Some(1));
        assert_eq!(step(&[case(-2, 0.01, 0.01), case(-1, 0.02, 0.02)]), None);
        assert_eq!(step(&[case(-1, 0.0, 0.0), case(0, 0.0, 0.0), case(1, 0.4, 0.4)]), Some(1));
        assert_eq!(step(&[]), None);
        assert_eq!(kernel(&steps), Some(1));
    }
}
