//! The container read byte by byte, without the reader that is to open it later: what is damaged
//! is listed even where the reader would stop at the first fault.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

use relief_formats::body::Body;
use relief_formats::file::header::{HEADER_BYTES, MAGIC};
use relief_formats::file::section::{INDEX, MAX_SECTIONS, MESH, META, ROW_BYTES, Section, TILES};
use relief_formats::file::writer::{TAIL_BYTES, tail};
use relief_formats::file::{FormatError, Header, Metadata};

use super::check::Check;
use super::finding::{Findings, Place};
use relief_front::error::ToolError;

/// The parts of a file that were found.
pub(super) struct Container {
    pub header: Header,
    pub sections: Vec<Section>,
}

/// A file that is read piecewise.
pub(super) struct Bytes<'a> {
    path: &'a Path,
    file: File,
    pub length: u64,
}

impl<'a> Bytes<'a> {
    /// # Errors
    /// [`ToolError::File`] when the file cannot be opened.
    pub fn open(path: &'a Path) -> Result<Self, ToolError> {
        let file = File::open(path).map_err(|error| io(path, "cannot open", error))?;
        let metadata = file.metadata().map_err(|error| io(path, "cannot read the size of", error))?;
        if metadata.is_dir() {
            return Err(io(path, "cannot read", ErrorKind::IsADirectory.into()));
        }
        Ok(Self { path, file, length: metadata.len() })
    }

    /// Bytes from `at` on: `n` of them, or as many as the file has.
    fn read(&mut self, at: u64, n: u64) -> Result<Vec<u8>, ToolError> {
        let n = n.min(self.length.saturating_sub(at));
        let mut bytes = Vec::with_capacity(n as usize);
        self.each(at, n, |_, piece| bytes.extend_from_slice(piece))?;
        Ok(bytes)
    }

    /// Hands the bytes of a range to `visit` in pieces; what lies beyond the file's end is left out.
    pub fn each(&mut self, at: u64, n: u64, mut visit: impl FnMut(u64, &[u8])) -> Result<(), ToolError> {
        let mut left = n.min(self.length.saturating_sub(at));
        let mut at = at;
        let mut buffer = vec![0; left.min(1 << 20) as usize];
        self.file.seek(SeekFrom::Start(at)).map_err(|error| io(self.path, "cannot seek in", error))?;
        while left > 0 {
            let piece = &mut buffer[..left.min(1 << 20) as usize];
            self.file.read_exact(piece).map_err(|error| io(self.path, "cannot read", error))?;
            visit(at, piece);
            at += piece.len() as u64;
            left -= piece.len() as u64;
        }
        Ok(())
    }
}

fn io(path: &Path, action: &'static str, error: std::io::Error) -> ToolError {
    ToolError::of_file(path)(FormatError::Io { action, path: path.to_path_buf(), error })
}

/// Reads header, tail, section table, padding and metadata. `None` when nothing beyond the header
/// can be trusted.
///
/// # Errors
/// When the file cannot be read, is no `.relief` at all, or is of a newer version.
pub(super) fn container(bytes: &mut Bytes<'_>, findings: &Findings) -> Result<Option<Container>, ToolError> {
    let head = bytes.read(0, HEADER_BYTES as u64)?;
    let end = bytes.read(bytes.length.saturating_sub(TAIL_BYTES as u64), TAIL_BYTES as u64)?;
    let of_file = ToolError::of_file(bytes.path);
    let agreeing = head.iter().zip(&MAGIC).filter(|(a, b)| a == b).count();
    if agreeing < MAGIC.len() {
        // A damaged signature is damage; another signature is another kind of file.
        let reversed = end.iter().zip(MAGIC.iter().rev()).filter(|(a, b)| a == b).count();
        let cut = head.len() < MAGIC.len() && agreeing == head.len();
        let named = bytes.path.extension().is_some_and(|end| end == "relief");
        if !(agreeing >= 4 || reversed >= 6 || cut && (named || !head.is_empty())) {
            return Err(of_file(FormatError::NotRelief("the first eight bytes are not its signature")));
        }
        findings.add(Check::Signature, Place::byte(0), format!("{agreeing} of the signature's 8 bytes are right"));
        return Ok(None);
    }
    let header = match Header::decode(&head) {
        Ok(header) => header,
        Err(error @ FormatError::Unsupported(_)) if checksum_holds(&head) => return Err(of_file(error)),
        Err(error) => {
            let what =
                if head.len() < HEADER_BYTES { "the file ends inside the header".into() } else { error.to_string() };
            findings.add(Check::Header, Place::byte(0), what);
            return Ok(None);
        }
    };
    if header.file_bytes != bytes.length {
        let what = format!("{} bytes, the header says {}", bytes.length, header.file_bytes);
        findings.add(Check::Length, Place::byte(header.file_bytes.min(bytes.length)), what);
    }
    let tail_at = header.file_bytes.saturating_sub(TAIL_BYTES as u64);
    let expected = tail(&header);
    let found = bytes.read(tail_at, TAIL_BYTES as u64)?;
    if found != expected {
        let differs = found.iter().zip(&expected).take_while(|(a, b)| a == b).count() as u64;
        findings.add(Check::Tail, Place::byte(tail_at + differs), "the tail is missing or is not the header's");
    }
    let rows = u64::from(header.section_count) * ROW_BYTES as u64;
    let begin = HEADER_BYTES as u64 + rows;
    if header.section_count > MAX_SECTIONS || begin > tail_at {
        let what = format!("{} sections, at most {MAX_SECTIONS} and as many as fit", header.section_count);
        findings.add(Check::SectionTable, Place::byte(96), what);
        return Ok(None);
    }
    let table = bytes.read(HEADER_BYTES as u64, rows)?;
    if *blake3::hash(&table).as_bytes() != header.table_hash {
        findings.add(Check::SectionTable, Place::byte(HEADER_BYTES as u64), "the table's checksum does not match");
        return Ok(None);
    }
    let sections = match Section::decode_table(&table, begin, tail_at) {
        Ok(sections) => sections,
        Err(error @ FormatError::Unsupported(_)) => return Err(of_file(error)),
        Err(error) => {
            findings.add(Check::SectionTable, Place::byte(HEADER_BYTES as u64), error.to_string());
            return Ok(None);
        }
    };
    let container = Container { header, sections };
    rows_are_canonical(&container, &table, findings);
    kinds(&container, findings);
    padding(bytes, &container, begin, tail_at, findings)?;
    metadata(bytes, &container, findings)?;
    Ok(Some(container))
}

fn checksum_holds(head: &[u8]) -> bool {
    head.len() == HEADER_BYTES && blake3::hash(&head[..224]).as_bytes()[..] == head[224..]
}

fn rows_are_canonical(container: &Container, table: &[u8], findings: &Findings) {
    for (n, (section, row)) in container.sections.iter().zip(table.chunks_exact(ROW_BYTES)).enumerate() {
        if section.encode() != *row {
            let place = Place::byte((HEADER_BYTES + n * ROW_BYTES) as u64);
            findings.add(Check::SectionTable, place, format!("row {n} has reserved bytes that are not zero"));
        }
    }
}

fn kinds(container: &Container, findings: &Findings) {
    for kind in [META, MESH, INDEX, TILES] {
        let count = container.sections.iter().filter(|section| section.kind == kind).count();
        if count != 1 {
            let name = String::from_utf8_lossy(&kind).into_owned();
            findings.add(Check::Sections, Place::byte(HEADER_BYTES as u64), format!("{count} sections {name}"));
        }
    }
}

fn padding(
    bytes: &mut Bytes<'_>,
    container: &Container,
    begin: u64,
    tail_at: u64,
    findings: &Findings,
) -> Result<(), ToolError> {
    let mut last = begin;
    let starts = container.sections.iter().map(|section| (section.offset, section.offset + section.length));
    for (start, stop) in starts.chain([(tail_at, tail_at)]) {
        let mut first = None;
        bytes.each(last, start - last, |at, piece| {
            let odd = piece.iter().position(|&byte| byte != 0);
            first = first.or(odd.map(|k| (at + k as u64, piece[k])));
        })?;
        if let Some((at, byte)) = first {
            findings.add(Check::Padding, Place::byte(at), format!("{byte:#04x} between two sections"));
        }
        last = stop;
    }
    Ok(())
}

fn metadata(bytes: &mut Bytes<'_>, container: &Container, findings: &Findings) -> Result<(), ToolError> {
    let Some(section) = container.sections.iter().find(|section| section.kind == META) else { return Ok(()) };
    let add = |what: String| findings.add(Check::Metadata, Place::byte(section.offset), what);
    if section.length > Metadata::MAX_BYTES {
        add(format!("{} bytes, at most {}", section.length, Metadata::MAX_BYTES));
        return Ok(());
    }
    let text = bytes.read(section.offset, section.length)?;
    let value: serde_json::Value = match serde_json::from_slice(&text) {
        Ok(value) => value,
        Err(error) => {
            add(format!("not JSON: {error}"));
            return Ok(());
        }
    };
    if format!("{value}\n").into_bytes() != text {
        add("not in canonical form: sorted keys, no spaces, one line end".into());
    }
    match Metadata::decode(&text) {
        Ok(metadata) => {
            if !same_body(&metadata.body, &container.header.body) {
                add("its body is not the header's".into());
            }
            let bound_m = container.header.step_m() / 2.0;
            if metadata.bound_m != bound_m {
                add(format!("bound_m is {}, half a step is {bound_m}", metadata.bound_m));
            }
        }
        Err(error) => add(error.to_string()),
    }
    Ok(())
}

/// Equal but for the texts, which the header does not hold.
fn same_body(a: &Body, b: &Body) -> bool {
    match (a, b) {
        (Body::Ellipsoid { a_m: a1, b_m: b1, .. }, Body::Ellipsoid { a_m: a2, b_m: b2, .. }) => (a1, b1) == (a2, b2),
        (Body::Plane { x0, y0, dx, dy, .. }, Body::Plane { x0: x, y0: y, dx: u, dy: v, .. }) => {
            (x0, y0, dx, dy) == (x, y, u, v)
        }
        _ => false,
    }
}

/// The BLAKE3 of every section.
pub(super) fn section_hashes(
    bytes: &mut Bytes<'_>,
    container: &Container,
    findings: &Findings,
    mut step: impl FnMut(u64),
) -> Result<(), ToolError> {
    for section in &container.sections {
        let mut hasher = blake3::Hasher::new();
        bytes.each(section.offset, section.length, |_, piece| {
            hasher.update(piece);
            step(piece.len() as u64);
        })?;
        if *hasher.finalize().as_bytes() != section.hash {
            let what = format!("section {} does not match its checksum", String::from_utf8_lossy(&section.kind));
            findings.add(Check::SectionHash, Place::byte(section.offset), what);
        }
    }
    Ok(())
}
