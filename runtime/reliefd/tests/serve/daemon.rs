//! The program as a child.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::balance::Balance;

/// Longer than anything takes on a busy machine.
pub const LONG: Duration = Duration::from_secs(60);

/// A daemon, until it is dropped.
pub struct Daemon {
    child: Child,
    address: String,
    log: Arc<Mutex<String>>,
}

impl Daemon {
    /// Serves files on the CPU with the usual patience.
    pub fn serve(files: &[&Path]) -> Self {
        Self::start(files, "", 1.0)
    }

    /// With more flags, and with its patience scaled.
    pub fn start(files: &[&Path], flags: &str, patience: f64) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_reliefd"))
            .args(["serve", "--listen", "auto", "--backend", "cpu", "--headless"])
            .args(flags.split_whitespace())
            .args(files)
            .env("RELIEFD_PATIENCE", patience.to_string())
            .env("RUST_LOG", "info")
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let log = Arc::new(Mutex::new(String::new()));
        let (kept, mut said) = (Arc::clone(&log), BufReader::new(child.stderr.take().unwrap()));
        std::thread::spawn(move || {
            let mut line = String::new();
            while said.read_line(&mut line).is_ok_and(|bytes| bytes > 0) {
                kept.lock().unwrap().push_str(&line);
                line.clear();
            }
        });
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        out.read_line(&mut line).unwrap();
        // Whatever else it prints must not block it.
        std::thread::spawn(move || out.read_to_end(&mut Vec::new()));
        let address = line.trim().strip_prefix("http://").unwrap_or_default().trim_end_matches('/').to_owned();
        let daemon = Self { child, address, log };
        assert!(!daemon.address.is_empty(), "{line}{}", daemon.log());
        daemon
    }

    /// HOST:PORT.
    pub fn address(&self) -> &str {
        &self.address
    }

    pub fn log(&self) -> String {
        self.log.lock().unwrap().clone()
    }

    /// Waits until the log says something so often.
    pub fn says(&self, what: &str, times: usize) {
        let deadline = Instant::now() + LONG;
        while self.log().matches(what).count() < times {
            assert!(Instant::now() < deadline, "{what:?} was not said {times} times:\n{}", self.log());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Sends a signal, such as HUP.
    pub fn signal(&self, name: &str) {
        let status = Command::new("kill").args([format!("-{name}"), self.child.id().to_string()]).status().unwrap();
        assert!(status.success());
    }

    /// What the process holds now.
    pub fn balance(&self) -> Balance {
        Balance::of(self.child.id())
    }

    /// Waits until the process holds no more than it did.
    pub fn settles(&self, before: Balance) {
        let deadline = Instant::now() + LONG;
        while let Err(grown) = self.balance().against(before) {
            assert!(Instant::now() < deadline, "{grown}\n{}", self.log());
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let ended = self.child.try_wait().unwrap();
        let _ = self.child.kill();
        let _ = self.child.wait();
        if !std::thread::panicking() {
            assert!(ended.is_none(), "the daemon ended by itself: {ended:?}\n{}", self.log());
            assert!(!self.log().contains("panicked"), "{}", self.log());
        }
    }
}
