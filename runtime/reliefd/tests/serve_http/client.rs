//! A client of a few lines, which sends what it is told, headers that lie included.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::Value;

/// Longest time for an answer: debug a hang, not a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// An answer.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: Vec<(String, String)>,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// The body as JSON of an answer with a status.
    pub fn json(&self, status: u16) -> Value {
        assert_eq!(self.status, status, "{}", self.text());
        assert_eq!(self.header("content-type"), Some("application/json"));
        serde_json::from_slice(&self.body).unwrap()
    }

    /// An answer of 200.
    pub fn good(self) -> Self {
        assert_eq!(self.status, 200, "{}", self.text());
        self
    }
}

/// Asks at an address, with header lines and a body.
pub fn ask(address: &str, method: &str, target: &str, lines: &[&str], body: &[u8]) -> Answer {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let mut head = format!("{method} {target} HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n", body.len());
    if !lines.iter().any(|line| line.starts_with("Host:")) {
        head += &format!("Host: {address}\r\n");
    }
    lines.iter().for_each(|line| head += &format!("{line}\r\n"));
    // Who is refused before the body was read may find the connection closed.
    let _ = stream.write_all(&[head.as_bytes(), b"\r\n", body].concat());
    let mut bytes = Vec::new();
    let read = stream.read_to_end(&mut bytes);
    read_answer(&bytes, method == "HEAD")
        .unwrap_or_else(|| panic!("no answer to {method} {target}: {read:?}, {bytes:?}"))
}

/// A request whose body has not been sent yet.
pub struct Unfinished(TcpStream, &'static str);

/// Begins to post JSON, and keeps it back.
pub fn begin_post(address: &str, target: &str, json: &'static str) -> Unfinished {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let head = format!(
        "POST {target} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\nContent-Type: application/json\r\n\
         Content-Length: {}\r\n\r\n",
        json.len()
    );
    stream.write_all(head.as_bytes()).unwrap();
    Unfinished(stream, json)
}

impl Unfinished {
    /// Sends what was kept back.
    pub fn finish(mut self) -> Answer {
        self.0.write_all(self.1.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        self.0.read_to_end(&mut bytes).unwrap();
        read_answer(&bytes, false).unwrap()
    }
}

fn read_answer(bytes: &[u8], bare: bool) -> Option<Answer> {
    let end = bytes.windows(4).position(|four| four == b"\r\n\r\n")?;
    let head = std::str::from_utf8(&bytes[..end]).ok()?;
    let mut lines = head.split("\r\n");
    let status = lines.next()?.split(' ').nth(1)?.parse().ok()?;
    let header = |line: &str| line.split_once(": ").map(|(name, value)| (name.to_ascii_lowercase(), value.to_owned()));
    let headers: Vec<(String, String)> = lines.filter_map(header).collect();
    let body = bytes[end + 4..].to_vec();
    let length = headers.iter().find(|(name, _)| name == "content-length").and_then(|(_, v)| v.parse().ok());
    let whole = bare || length.is_none_or(|length: usize| length == body.len());
    assert!(whole, "a body of {} bytes: {head}", body.len());
    Some(Answer { status, headers, body })
}
