//! How far a command is: a bar with an honest time left, or plain lines where no one sees a bar.

use std::io::IsTerminal as _;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use relief_front::stderr::say;

/// Progress over a known amount of work. Without a terminal a line is printed at every tenth, but
/// not more often than every two seconds.
pub struct Progress {
    bar: Option<ProgressBar>,
    plain: Option<Mutex<Plain>>,
    total: u64,
}

struct Plain {
    done: u64,
    tenths: u64,
    start: Instant,
    last: Instant,
    label: String,
}

impl Progress {
    /// Shows nothing when `quiet`.
    #[must_use]
    pub fn new(label: &str, total: u64, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = (!quiet && terminal).then(|| {
            let bar = ProgressBar::new(total);
            let style = ProgressStyle::with_template("{prefix} [{bar:30}] {percent:>3} %  {elapsed} gone, {eta} left");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
            bar.set_prefix(label.to_string());
            bar.enable_steady_tick(Duration::from_millis(500));
            bar
        });
        let now = Instant::now();
        let plain = (!quiet && !terminal)
            .then(|| Mutex::new(Plain { done: 0, tenths: 0, start: now, last: now, label: label.to_string() }));
        Self { bar, plain, total }
    }

    /// Adds finished work.
    pub fn add(&self, amount: u64) {
        if let Some(bar) = &self.bar {
            bar.inc(amount);
        }
        let Some(Ok(mut plain)) = self.plain.as_ref().map(Mutex::lock) else { return };
        plain.done += amount;
        let tenths = plain.done * 10 / self.total.max(1);
        if tenths > plain.tenths && (plain.last.elapsed() > Duration::from_secs(2)) {
            let gone = plain.start.elapsed().as_secs_f64();
            let left = gone * (self.total.saturating_sub(plain.done)) as f64 / plain.done as f64;
            say(&format!("{}: {} %, {gone:.0} s gone, about {left:.0} s left", plain.label, tenths * 10));
            plain.tenths = tenths;
            plain.last = Instant::now();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
