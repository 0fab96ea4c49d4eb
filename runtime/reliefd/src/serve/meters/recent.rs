//! Times of the last minutes, for quantiles that follow what happens now.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// How long a time counts.
const AGE: Duration = Duration::from_secs(300);
/// More of them are not needed for a quantile.
const MOST: usize = 4096;

/// Times that are not old.
#[derive(Default)]
pub struct Recent(VecDeque<(Instant, f64)>);

impl Recent {
    /// Something took so many seconds.
    pub fn add(&mut self, now: Instant, seconds: f64) {
        self.forget(now);
        if self.0.len() == MOST {
            self.0.pop_front();
        }
        self.0.push_back((now, seconds));
    }

    /// The times, in seconds, that a share of them (0 to 1) did not exceed; 0 without any.
    pub fn quantiles<const N: usize>(&mut self, now: Instant, shares: [f64; N]) -> [f64; N] {
        self.forget(now);
        let mut sorted: Vec<f64> = self.0.iter().map(|&(_, seconds)| seconds).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        // The nearest rank.
        let rank = |share: f64| ((share * sorted.len() as f64).ceil() as usize).saturating_sub(1);
        shares.map(|share| sorted.get(rank(share)).copied().unwrap_or(0.0))
    }

    fn forget(&mut self, now: Instant) {
        while self.0.front().is_some_and(|&(then, _)| now.saturating_duration_since(then) > AGE) {
            self.0.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_of_what_is_recent() {
        let (mut recent, start) = (Recent::default(), Instant::now());
        assert_eq!(recent.quantiles(start, [0.5, 0.99]), [0.0, 0.0]);
        recent.add(start, 100.0);
        let later = start + AGE + Duration::from_secs(1);
        for k in 1..=100 {
            recent.add(later, f64::from(k));
        }
        assert_eq!(recent.quantiles(later, [0.0, 0.5, 0.95, 0.99, 1.0]), [1.0, 50.0, 95.0, 99.0, 100.0]);
        for _ in 0..2 * MOST {
            recent.add(later, 7.0);
        }
        assert_eq!((recent.0.len(), recent.quantiles(later, [1.0])), (MOST, [7.0]));
    }
}
