//! How far a validation is: a bar on a terminal, a line now and then elsewhere.

use std::io::IsTerminal as _;
use std::sync::atomic::{AtomicU64, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

/// One stage's progress; shared by all threads.
pub(super) struct Progress {
    name: &'static str,
    total: u64,
    done: AtomicU64,
    shown: Shown,
}

enum Shown {
    Nothing,
    Lines,
    Bar(ProgressBar),
}

impl Progress {
    /// A stage of `total` steps.
    pub fn new(name: &'static str, total: u64, quiet: bool) -> Self {
        let shown = if quiet {
            Shown::Nothing
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(total);
            if let Ok(style) = ProgressStyle::with_template("{msg:>10} {wide_bar} {percent:>3} % {eta}") {
                bar.set_style(style);
            }
            bar.set_message(name);
            Shown::Bar(bar)
        } else {
            Shown::Lines
        };
        Self { name, total, done: AtomicU64::new(0), shown }
    }

    /// `n` more steps are done.
    pub fn step(&self, n: u64) {
        match &self.shown {
            Shown::Nothing => {}
            Shown::Bar(bar) => bar.inc(n),
            Shown::Lines => {
                let before = self.done.fetch_add(n, Ordering::Relaxed);
                let quarter = |done: u64| 4 * done / self.total.max(1);
                if quarter(before + n) > quarter(before) {
                    eprintln!("{}: {} %", self.name, 25 * quarter(before + n).min(4));
                }
            }
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Shown::Bar(bar) = &self.shown {
            bar.finish_and_clear();
        }
    }
}
