//! Errors gathered: how many, the largest, and the root of the mean square.

/// Differences in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// How many were compared.
    pub count: u64,
    /// The largest, metres.
    pub max_m: f64,
    squares: f64,
}

impl Errors {
    /// Takes in one difference.
    pub fn add(&mut self, difference_m: f64) {
        self.count += 1;
        self.max_m = self.max_m.max(difference_m.abs());
        self.squares += difference_m * difference_m;
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            max_m: self.max_m.max(other.max_m),
            squares: self.squares + other.squares,
        }
    }

    /// Root of the mean square, metres; 0 of nothing.
    #[must_use]
    pub fn rms_m(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.squares / self.count as f64).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::Errors;

    #[test]
    fn largest_and_root_mean_square() {
        let (mut a, mut b) = (Errors::default(), Errors::default());
        a.add(-3.0);
        b.add(1.0);
        b.add(1.0);
        let both = a.and(b);
        assert_eq!((both.count, both.max_m), (3, 3.0));
        assert!((both.rms_m() - (11.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(Errors::default().rms_m(), 0.0);
    }
}
