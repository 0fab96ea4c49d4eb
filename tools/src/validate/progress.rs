//! How far a validation is: a bar on a terminal, elsewhere a line every two seconds at most.

use std::io::IsTerminal as _;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Time between two plain lines.
const PAUSE: Duration = Duration::from_secs(2);

/// One stage's progress; shared by all threads.
pub(super) struct Progress {
    name: &'static str,
    total: u64,
    shown: Shown,
}

enum Shown {
    Nothing,
    /// Steps done, and when the last line was printed.
    Lines(Mutex<(u64, Instant)>),
    Bar(ProgressBar),
}

impl Progress {
    /// A stage of `total` steps.
    pub fn new(name: &'static str, total: u64, quiet: bool) -> Self {
        let shown = if quiet {
            Shown::Nothing
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(total);
            if let Ok(style) =
                ProgressStyle::with_template("{msg:>8} [{bar:30}] {percent:>3} %  {elapsed} gone, {eta} left")
            {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.set_message(name);
            Shown::Bar(bar)
        } else {
            Shown::Lines(Mutex::new((0, Instant::now())))
        };
        Self { name, total, shown }
    }

    /// `n` more steps are done.
    pub fn step(&self, n: u64) {
        match &self.shown {
            Shown::Nothing => {}
            Shown::Bar(bar) => bar.inc(n),
            Shown::Lines(state) => {
                let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
                state.0 += n;
                if state.1.elapsed() > PAUSE {
                    state.1 = Instant::now();
                    eprintln!("{}: {} %", self.name, 100 * state.0 / self.total.max(1));
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
