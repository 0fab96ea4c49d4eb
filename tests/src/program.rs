//! A program run to its end, and what it said.

use std::io::Write as _;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// How a run of a program ended.
#[derive(Clone, Debug)]
pub struct Run {
    /// Exit code.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Run {
    /// Runs a command with text on standard input.
    pub fn of(command: &mut Command, stdin: &str) -> Self {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let text = stdin.to_owned();
        let mut input = child.stdin.take().unwrap();
        let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
        let run = Self::from(child.wait_with_output().unwrap());
        // A program that refuses its arguments need not read.
        let _ = writer.join().unwrap();
        run
    }

    /// The exit code of a command whose standard error nobody reads.
    pub fn unheard(command: &mut Command) -> Option<i32> {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(writer).status().unwrap().code()
    }

    /// Itself, after a run that was good.
    pub fn good(self) -> Self {
        assert_eq!(self.code, 0, "{}{}", self.stdout, self.stderr);
        self
    }

    /// Standard output as JSON, after a run that ended with `code`.
    pub fn json(&self, code: i32) -> Value {
        assert_eq!(self.code, code, "{}", self.stderr);
        serde_json::from_str(&self.stdout).unwrap()
    }

    /// A message with all its parts, on exit code 2 and nothing on standard output.
    pub fn refused(&self, words: &[&str]) {
        assert_eq!(self.code, 2, "{}{}", self.stdout, self.stderr);
        assert!(self.stdout.is_empty(), "{}", self.stdout);
        for word in words.iter().chain(&["remedy:"]) {
            assert!(self.stderr.contains(word), "{word:?} is not in: {}", self.stderr);
        }
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let words = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code().unwrap(), stdout: words(output.stdout), stderr: words(output.stderr) }
    }
}
