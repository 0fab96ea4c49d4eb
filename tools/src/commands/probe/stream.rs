//! Points on standard input, answered in batches.
//!
//! A thread reads ahead while a batch is answered, and the next batch takes all that has been
//! read: a slow writer gets its answers at once, a fast one is answered in large batches, which
//! are sorted by tile so that each tile is decoded once.

use std::io::{self, BufWriter, Read, Write as _};
use std::ops::Range;
use std::sync::mpsc::{Receiver, sync_channel};

use rayon::prelude::*;
use relief_formats::file::{Entry, FormatError};
use relief_formats::surface::{Place, PointSample};

use super::answer::{Prober, parse_point};
use crate::commands::Outcome;
use relief_front::error::ToolError;
use relief_front::stdout::settle;

const CHUNK_BYTES: usize = 1 << 18;
/// Chunks that may wait, and so also a batch: about 700 000 points, 200 MB with all that is
/// known of them. Points all over a map cost a decoding of most of its tiles for each batch.
const CHUNKS: usize = 64;
/// No line of two numbers is longer.
const LINE_BYTES: usize = 1 << 16;
/// Lines that one task prints, and tasks whose text is held before it is written.
const LINES: usize = 4096;
const PARTS: usize = 32;

/// Answers every line of `input` on standard output.
///
/// # Errors
/// A damaged tile, or a system that refuses to read or write.
pub fn run(
    prober: &Prober<'_>,
    input: impl Read + Send + 'static,
    in_file: impl Fn(FormatError) -> ToolError,
) -> Result<Outcome, ToolError> {
    let chunks = read_ahead(input);
    let mut out = BufWriter::with_capacity(CHUNK_BYTES, io::stdout().lock());
    let mut batch = Vec::new();
    let mut lines_before = 0;
    let mut outcome = Outcome::Good;
    loop {
        let more = take_waiting(&chunks, &mut batch)?;
        let whole = if more { batch.iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1) } else { batch.len() };
        let lines: Vec<&[u8]> = split_lines(&batch[..whole]);
        let answers = answer(prober, &lines).map_err(&in_file)?;
        if !answers.errors.is_empty() {
            outcome = Outcome::Found;
        }
        for start in (0..lines.len()).step_by(LINES * PARTS) {
            let range = start..lines.len().min(start + LINES * PARTS);
            for text in answers.print(prober, range, lines_before) {
                if !settle(out.write_all(text.as_bytes()))? {
                    return Ok(outcome);
                }
            }
        }
        if !settle(out.flush())? || !more {
            return Ok(outcome);
        }
        lines_before += lines.len() as u64;
        batch.drain(..whole);
        if batch.len() > LINE_BYTES {
            return Err(ToolError::usage(
                format!("line {} of standard input is longer than {LINE_BYTES} bytes", lines_before + 1),
                "a line holds two numbers, `lon lat`",
                "check what is written to standard input",
            ));
        }
    }
}

/// Starts the thread that reads.
fn read_ahead(mut input: impl Read + Send + 'static) -> Receiver<io::Result<Vec<u8>>> {
    let (sender, receiver) = sync_channel(CHUNKS);
    std::thread::spawn(move || {
        loop {
            let mut chunk = vec![0; CHUNK_BYTES];
            let read = match input.read(&mut chunk) {
                Ok(0) => return,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Ok(n) => {
                    chunk.truncate(n);
                    Ok(chunk)
                }
                Err(error) => Err(error),
            };
            let last = read.is_err();
            // The receiver goes away when the output does.
            if sender.send(read).is_err() || last {
                return;
            }
        }
    });
    receiver
}

/// Waits for a chunk and appends it and those that wait behind it; false at the end of the input.
fn take_waiting(chunks: &Receiver<io::Result<Vec<u8>>>, batch: &mut Vec<u8>) -> Result<bool, ToolError> {
    let Ok(first) = chunks.recv() else { return Ok(false) };
    for chunk in std::iter::once(first).chain(chunks.try_iter().take(CHUNKS)) {
        let failed = |error| ToolError::Io {
            action: "cannot read",
            path: "standard input".into(),
            error,
            remedy: "check what standard input is connected to".into(),
        };
        batch.extend(chunk.map_err(failed)?);
    }
    Ok(true)
}

fn split_lines(bytes: &[u8]) -> Vec<&[u8]> {
    let mut lines: Vec<&[u8]> = bytes.split(|&b| b == b'\n').collect();
    if bytes.ends_with(b"\n") || bytes.is_empty() {
        lines.pop();
    }
    lines
}

struct Question {
    line: usize,
    point: [f64; 2],
    place: Place,
    answer: PointSample,
}

/// All that came of a batch, both in order of lines.
struct Answers {
    good: Vec<Question>,
    errors: Vec<(usize, String)>,
}

/// Reads the lines, sorts the points by tile and samples each tile once.
fn answer(prober: &Prober<'_>, lines: &[&[u8]]) -> Result<Answers, FormatError> {
    let unanswered = PointSample { height_m: f64::NAN, filled: false, bounds_m: [f64::NAN; 2] };
    let read = |(line, bytes): (usize, &&[u8])| {
        let text = str::from_utf8(bytes).map_err(|_| "the line is no UTF-8 text".to_owned())?;
        let point = parse_point(text)?;
        let place = prober.place(point).map_err(|error| error.to_string())?;
        Ok(Question { line, point, place, answer: unanswered })
    };
    let parsed: Vec<Result<Question, String>> = lines.par_iter().enumerate().map(read).collect();
    let mut errors = Vec::new();
    let mut good = Vec::with_capacity(parsed.len());
    for (line, question) in parsed.into_iter().enumerate() {
        match question {
            Ok(question) => good.push(question),
            Err(error) => errors.push((line, error)),
        }
    }
    good.par_sort_unstable_by_key(|q| Entry::sort_key(q.place.tile));
    good.par_chunk_by_mut(|a, b| a.place.tile == b.place.tile).try_for_each(|group| {
        let Some(first) = group.first() else { return Ok(()) };
        let tile = prober.surface.tile(first.place.tile)?;
        for question in group {
            question.answer = tile.sample(&question.place);
        }
        Ok(())
    })?;
    good.par_sort_unstable_by_key(|q| q.line);
    Ok(Answers { good, errors })
}

impl Answers {
    /// The text of some lines, in parts of [`LINES`].
    fn print(&self, prober: &Prober<'_>, lines: Range<usize>, lines_before: u64) -> Vec<String> {
        let starts: Vec<usize> = lines.clone().step_by(LINES).collect();
        starts
            .into_par_iter()
            .map(|start| self.print_part(prober, start..lines.end.min(start + LINES), lines_before))
            .collect()
    }

    fn print_part(&self, prober: &Prober<'_>, lines: Range<usize>, lines_before: u64) -> String {
        let mut good = &self.good[self.good.partition_point(|q| q.line < lines.start)..];
        let mut errors = &self.errors[self.errors.partition_point(|e| e.0 < lines.start)..];
        let mut text = String::with_capacity(200 * lines.len());
        for line in lines {
            if let Some((question, rest)) = good.split_first().filter(|(q, _)| q.line == line) {
                prober.write_json(&mut text, question.point, &question.answer);
                good = rest;
            } else if let Some(((_, error), rest)) = errors.split_first() {
                let number = lines_before + line as u64 + 1;
                text.push_str(&serde_json::json!({ "line": number, "error": error }).to_string());
                errors = rest;
            }
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_where_they_end() {
        let lines = |text: &'static str| split_lines(text.as_bytes()).iter().map(|l| l.len()).collect::<Vec<_>>();
        assert_eq!(lines(""), [0usize; 0]);
        assert_eq!(lines("ab"), [2]);
        assert_eq!(lines("ab\n"), [2]);
        assert_eq!(lines("ab\n\nc"), [2, 0, 1]);
        assert_eq!(lines("\n"), [0]);
    }
}
