//! How long the daemon waits for those it serves, and how often it looks at its files.

use std::sync::OnceLock;
use std::time::Duration;

/// Spans of time.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// For the first message of a viewer.
    pub hello: Duration,
    /// Between pings: a viewer that is there answers them.
    pub ping: Duration,
    /// Of silence, pongs included, after which nobody is there.
    pub silence: Duration,
    /// For a message to be taken by a viewer.
    pub send: Duration,
    /// For any byte on a connection.
    pub idle: Duration,
    /// Between two looks at the files.
    pub look: Duration,
}

/// The usual ones, times the number in the environment variable `RELIEFD_PATIENCE`: tests have less.
pub fn patience() -> Patience {
    static SCALE: OnceLock<f64> = OnceLock::new();
    let scale = *SCALE.get_or_init(|| scale(std::env::var("RELIEFD_PATIENCE").ok().as_deref()));
    let seconds = |s: f64| Duration::from_secs_f64(s * scale);
    Patience {
        hello: seconds(10.0),
        ping: seconds(20.0),
        silence: seconds(65.0),
        send: seconds(30.0),
        idle: seconds(150.0),
        look: seconds(1.0),
    }
}

fn scale(text: Option<&str>) -> f64 {
    text.and_then(|text| text.parse().ok()).filter(|scale| (1e-3..=1e3).contains(scale)).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_sensible_number_counts_as_one() {
        for (text, expected) in
            [(None, 1.0), (Some("0.05"), 0.05), (Some("0"), 1.0), (Some("-1"), 1.0), (Some("x"), 1.0)]
        {
            assert_eq!(scale(text), expected, "{text:?}");
        }
        assert_eq!((scale(Some("nan")), scale(Some("1e9"))), (1.0, 1.0));
    }
}
