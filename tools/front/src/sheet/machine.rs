//! Where and when figures were measured.

use std::time::{SystemTime, UNIX_EPOCH};

/// The machine as a reader wants to know it.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Processor.
    pub cpu: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Operating system.
    pub system: String,
    /// Runnable processes over the last minute before the start; none where the system does not say.
    pub load: Option<f64>,
    /// Day of the start, UTC, as YYYY-MM-DD.
    pub date: String,
}

impl Machine {
    /// This one, now.
    #[must_use]
    pub fn here() -> Self {
        let value = |path: &str, key: &str, sign: char| {
            let text = std::fs::read_to_string(path).ok()?;
            let line = text.lines().find(|line| line.starts_with(key))?;
            Some(line.split_once(sign)?.1.trim().trim_matches('"').to_owned())
        };
        let load = std::fs::read_to_string("/proc/loadavg").ok();
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        Self {
            cpu: value("/proc/cpuinfo", "model name", ':').unwrap_or_else(|| std::env::consts::ARCH.into()),
            cores: std::thread::available_parallelism().map_or(1, Into::into),
            system: value("/etc/os-release", "PRETTY_NAME", '=').unwrap_or_else(|| std::env::consts::OS.into()),
            load: load.and_then(|text| text.split(' ').next()?.parse().ok()),
            date: day(seconds / 86_400),
        }
    }

    /// Others kept the cores busy: times are then too long, and unequally so.
    #[must_use]
    pub fn busy(&self) -> bool {
        self.load.is_some_and(|load| load > 0.5 * self.cores as f64)
    }
}

/// The day that is `days` after 1970-01-01 in the Gregorian calendar.
fn day(days: u64) -> String {
    // Years begin in March, so that a leap day is the last; 146097 days are 400 years.
    let shifted = days + 719_468;
    let (era, of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let march_month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * march_month + 2) / 5 + 1;
    let month = if march_month < 10 { march_month + 3 } else { march_month - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::{Machine, day};

    #[test]
    fn days_of_the_calendar() {
        for (days, name) in [(0, "1970-01-01"), (59, "1970-03-01"), (11_016, "2000-02-29"), (20_454, "2026-01-01")] {
            assert_eq!(day(days), name);
        }
    }

    #[test]
    fn a_busy_machine_is_known() {
        let machine = Machine { load: Some(1.5), cores: 2, ..Machine::here() };
        assert!(machine.busy() && !Machine { load: Some(0.2), ..machine.clone() }.busy());
        assert!(!Machine { load: None, ..machine }.busy());
    }
}
