//! Points on standard input, answered in batches: a slow writer gets its answers at once, a fast
//! one is answered in large batches.

use std::io::{BufRead, BufReader, Read, Write as _};

use relief_front::error::ToolError;
use relief_front::stdout::settle;

use super::answer::{At, Prober, parse_point};
use crate::Outcome;

/// Lines of a batch.
const BATCH: usize = 1 << 16;
/// No line of two numbers is longer.
const LINE_BYTES: u64 = 1 << 12;

/// Answers every line of `input` on standard output.
///
/// # Errors
/// A damaged tile, or a system that refuses to read or write.
pub fn run(prober: &mut Prober, input: impl Read) -> Result<Outcome, ToolError> {
    let mut input = BufReader::with_capacity(1 << 18, input);
    let mut outcome = Outcome::Good;
    let mut lines_before = 0;
    loop {
        let batch = lines(&mut input, lines_before)?;
        if batch.is_empty() {
            return Ok(outcome);
        }
        let places: Vec<Result<At, String>> =
            batch.iter().map(|line| parse_point(line).and_then(|point| prober.place(point))).collect();
        let good: Vec<At> = places.iter().flatten().copied().collect();
        let mut answers = prober.answers(&good)?.into_iter();
        let mut text = String::new();
        for (k, place) in (1..).zip(&places) {
            match place {
                Ok(_) => text.extend(answers.next().map(|answer| answer.json())),
                Err(error) => {
                    outcome = Outcome::Found;
                    text.push_str(&serde_json::json!({"line": lines_before + k, "error": error}).to_string());
                }
            }
            text.push('\n');
        }
        let mut out = std::io::stdout().lock();
        if !settle(out.write_all(text.as_bytes()).and_then(|()| out.flush()))? {
            return Ok(outcome);
        }
        lines_before += batch.len();
    }
}

/// The lines that have come, at least one unless the input has ended.
fn lines(input: &mut BufReader<impl Read>, lines_before: usize) -> Result<Vec<String>, ToolError> {
    let mut batch = Vec::new();
    while batch.len() < BATCH && (batch.is_empty() || input.buffer().contains(&b'\n')) {
        let mut line = Vec::new();
        let read = input.by_ref().take(LINE_BYTES).read_until(b'\n', &mut line).map_err(|error| ToolError::Io {
            action: "cannot read",
            path: "standard input".into(),
            error,
            remedy: "check what standard input is connected to".into(),
        })?;
        if read == 0 {
            break;
        }
        if read as u64 == LINE_BYTES && line.last() != Some(&b'\n') {
            return Err(ToolError::usage(
                format!("line {} of standard input is longer than {LINE_BYTES} bytes", lines_before + batch.len() + 1),
                "a line holds two numbers, `lon lat`",
                "check what is written to standard input",
            ));
        }
        batch.push(String::from_utf8_lossy(&line).into_owned());
    }
    Ok(batch)
}
