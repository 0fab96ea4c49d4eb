//! The daemon, started on files whose heights are known.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use relief_formats::body::Body;

use crate::client::{Answer, ask};
use crate::sample_file::Sample;

/// Longest time for anything that is waited for.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Side of a plane's cell, metres.
pub const SPACING_M: f64 = 30.0;

/// A folder with `globe.relief` (the Earth, m = 9) and `plane.relief` (256 x 256 cells).
pub struct Files(tempfile::TempDir);

impl Files {
    pub fn new() -> Self {
        let files = Self(tempfile::tempdir().unwrap());
        Sample::new(Body::earth(), 9).write(&files.path("globe.relief"));
        let body = Body::Plane { crs_wkt: String::new(), x0: 1000.0, y0: 2000.0, dx: SPACING_M, dy: SPACING_M };
        Sample::new(body, 8).write(&files.path("plane.relief"));
        files
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
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
        words.split_whitespace().map(|word| word.replace("DIR/", &format!("{}/", self.0.path().display()))).collect()
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

/// Pixels of an 8-bit PNG: width, height, channels, samples.
pub fn png(bytes: &[u8]) -> (u32, u32, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut samples).unwrap();
    (info.width, info.height, info.color_type.samples(), samples)
}

/// A file's bytes.
pub fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}
