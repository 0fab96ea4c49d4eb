//! The daemon, started on files whose heights are known.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use relief_tests::folder::Folder;
use relief_tests::plane::plane;
use relief_tests::sample_file::wavy_q;

use crate::client::{Answer, ask};

/// Longest time for anything that is waited for.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A folder with `globe.relief` (the Earth, m = 9) and `plane.relief` (256 x 256 cells).
pub struct Files(Folder);

impl Files {
    pub fn new() -> Self {
        let folder = Folder::new();
        folder.globe("globe.relief", 9);
        folder.sample("plane.relief", &plane(wavy_q));
        Self(folder)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }

    /// A command of the program in words, `DIR/` standing for this folder.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_reliefd"));
        command.args(self.words(words)).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // What the developer has set is not what is tested.
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("RELIEFD_")) {
            command.env_remove(name);
        }
        command.env_remove("NOTIFY_SOCKET").env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command
    }

    pub fn words(&self, words: &str) -> Vec<String> {
        words.split_whitespace().map(|word| word.replace("DIR/", &format!("{}/", self.0.dir().display()))).collect()
    }
}

/// A daemon that runs; dropping it kills it.
pub struct Daemon {
    child: Child,
    /// What it printed.
    pub url: String,
}

impl Daemon {
    /// A daemon of both files, with further words.
    pub fn start(files: &Files, words: &str) -> Self {
        Self::spawn(files.command(&format!(
            "serve DIR/globe.relief DIR/plane.relief --backend cpu --listen auto --headless {words}"
        )))
    }

    pub fn spawn(mut command: Command) -> Self {
        let mut child = command.spawn().unwrap();
        let mut url = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut url).unwrap();
        if url.is_empty() {
            let output = child.wait_with_output().unwrap();
            panic!("it did not start: {}", String::from_utf8_lossy(&output.stderr));
        }
        Self { child, url: url.trim().to_owned() }
    }

    /// HOST:PORT.
    pub fn address(&self) -> &str {
        self.url.trim_start_matches("http://").trim_end_matches('/')
    }

    pub fn get(&self, target: &str) -> Answer {
        ask(self.address(), "GET", target, &[], b"")
    }

    pub fn post(&self, target: &str, json: &str) -> Answer {
        ask(self.address(), "POST", target, &["Content-Type: application/json"], json.as_bytes())
    }

    /// Sends a signal by its name.
    pub fn signal(&self, name: &str) {
        let pid = self.child.id().to_string();
        assert!(Command::new("kill").args(["-s", name, &pid]).status().unwrap().success());
    }

    /// Waits for its end: the exit code, and the log.
    pub fn ended(mut self) -> (i32, String) {
        let status = poll("the daemon's end", || self.child.try_wait().unwrap());
        let mut log = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut log).unwrap();
        (status.code().unwrap_or(-1), log)
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Asks again and again until there is an answer.
pub fn poll<T>(what: &str, mut question: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(answer) = question() {
            return answer;
        }
        assert!(Instant::now() < deadline, "waited too long for {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Runs a command of the program to its end: exit code and standard error.
pub fn run(files: &Files, words: &str) -> (i32, String) {
    let output = files.command(words).output().unwrap();
    (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A file's bytes.
pub fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}
