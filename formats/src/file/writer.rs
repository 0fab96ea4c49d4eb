//! Putting a file together and publishing it: temporary file, sync, rename, sync of the folder.

use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::header::{HASH_AT as HEADER_HASH_AT, HEADER_BYTES, MAGIC};
use super::index::{ENTRY_BYTES, content_id};
use super::section::{self, INDEX, MESH, META, ROW_BYTES, Section, TILES};
use super::{Entry, FormatError, Header, Metadata, temporary};
use crate::body::Body;

/// Bytes of the tail.
pub const TAIL_BYTES: usize = 64;

/// What a file holds besides its tiles.
#[derive(Clone, Debug)]
pub struct FileSpec<'a> {
    /// What the heights stand on.
    pub body: &'a Body,
    /// The map exponent.
    pub m: u32,
    /// Heights are q 2^`step_exponent` metres.
    pub step_exponent: i8,
    /// Height of the South Pole (a plane: node (0, 0)), in steps.
    pub south_pole_q: i32,
    /// Height of the North Pole (a plane: its last node), in steps.
    pub north_pole_q: i32,
    /// Where the heights come from.
    pub metadata: &'a Metadata,
    /// The encoded patch mesh.
    pub mesh: &'a [u8],
}

/// Writes a file at `path`, replacing what is there only once the new one is whole and synced.
///
/// `entries` need not be sorted and their `offset` is ignored: `read` appends the bytes of one
/// entry's planes, by its number in `entries`, to the buffer it is given.
pub fn write(
    path: &Path,
    spec: &FileSpec<'_>,
    entries: &[Entry],
    mut read: impl FnMut(usize, &mut Vec<u8>) -> std::io::Result<()>,
) -> Result<Header, FormatError> {
    let io = |action: &'static str| {
        let path = path.to_path_buf();
        move |error| FormatError::Io { action, path, error }
    };
    let mut order: Vec<usize> = (0..entries.len()).collect();
    order.sort_unstable_by_key(|&k| entries[k].key);
    let mut placed = Vec::with_capacity(entries.len());
    let mut offset = 0;
    for &k in &order {
        let entry = Entry { offset, ..entries[k] };
        offset += entry.bytes();
        placed.push(entry);
    }

    let staging = Staging::beside(path);
    let file = File::create(&staging.path).map_err(io("cannot create"))?;
    temporary::hold(&file);
    let mut out = BufWriter::with_capacity(1 << 20, file);
    let failed = io("cannot write");
    let header = write_all(&mut out, spec, &order, &placed, &mut read).map_err(|error| match error {
        Failure::Io(error) => failed(error),
        Failure::Format(error) => error,
    })?;
    let file = out.into_inner().map_err(|e| io("cannot write")(e.into_error()))?;
    file.sync_all().map_err(io("cannot sync"))?;
    staging.publish(path)?;
    Ok(header)
}

enum Failure {
    Io(std::io::Error),
    Format(FormatError),
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

fn write_all(
    out: &mut BufWriter<File>,
    spec: &FileSpec<'_>,
    order: &[usize],
    placed: &[Entry],
    read: &mut impl FnMut(usize, &mut Vec<u8>) -> std::io::Result<()>,
) -> Result<Header, Failure> {
    let metadata = spec.metadata.encode().map_err(Failure::Format)?;
    let mut index = Vec::with_capacity(placed.len() * ENTRY_BYTES);
    for entry in placed {
        index.extend_from_slice(&entry.encode());
    }
    let sections = 4;
    let mut position = (HEADER_BYTES + sections * ROW_BYTES) as u64;
    out.write_all(&vec![0; position as usize])?;
    let mut table = Vec::new();
    for (kind, bytes) in [(META, &metadata[..]), (MESH, spec.mesh), (INDEX, &index)] {
        table.push(Section {
            kind,
            flags: 0,
            offset: position,
            length: bytes.len() as u64,
            hash: *blake3::hash(bytes).as_bytes(),
        });
        out.write_all(bytes)?;
        let next = section::align(position + bytes.len() as u64);
        out.write_all(&vec![0; (next - position) as usize - bytes.len()])?;
        position = next;
    }
    let start = position;
    let mut hasher = blake3::Hasher::new();
    let mut buffer = Vec::new();
    for (&k, entry) in order.iter().zip(placed) {
        buffer.clear();
        read(k, &mut buffer)?;
        if buffer.len() as u64 != entry.bytes() {
            return Err(Failure::Format(FormatError::Request(
                "a tile's bytes are not as long as its entry says".into(),
            )));
        }
        hasher.update(&buffer);
        out.write_all(&buffer)?;
        position += buffer.len() as u64;
    }
    table.push(Section {
        kind: TILES,
        flags: 0,
        offset: start,
        length: position - start,
        hash: *hasher.finalize().as_bytes(),
    });
    let tail_at = section::align(position);
    out.write_all(&vec![0; (tail_at - position) as usize])?;

    let rows: Vec<u8> = table.iter().flat_map(Section::encode).collect();
    let mut header = Header {
        body: spec.body.clone(),
        m: spec.m,
        step_exponent: spec.step_exponent,
        south_pole_q: spec.south_pole_q,
        north_pole_q: spec.north_pole_q,
        min_q: placed.iter().map(|e| e.min_q).min().unwrap_or(0),
        max_q: placed.iter().map(|e| e.max_q).max().unwrap_or(0),
        tile_count: placed.len() as u64,
        file_bytes: tail_at + TAIL_BYTES as u64,
        content_id: [0; 32],
        section_count: sections as u32,
        table_hash: *blake3::hash(&rows).as_bytes(),
    };
    header.content_id = content_id(&header.identity_bytes(), placed.iter());
    let head = header.encode();
    out.write_all(&tail_of(&head, header.file_bytes))?;
    out.seek(SeekFrom::Start(0))?;
    out.write_all(&head)?;
    out.write_all(&rows)?;
    out.flush()?;
    Ok(header)
}

/// The last 64 bytes: the signature backwards, the file's size, the header's checksum, zeros.
#[must_use]
pub fn tail(header: &Header) -> [u8; TAIL_BYTES] {
    tail_of(&header.encode(), header.file_bytes)
}

/// The tail of a file with these header bytes, of which a newer version may have written more than
/// [`Header`] knows.
pub(super) fn tail_of(header: &[u8], file_bytes: u64) -> [u8; TAIL_BYTES] {
    let mut bytes = [0; TAIL_BYTES];
    for (to, from) in bytes.iter_mut().zip(MAGIC.iter().rev()) {
        *to = *from;
    }
    bytes[8..16].copy_from_slice(&file_bytes.to_le_bytes());
    bytes[16..48].copy_from_slice(&header[HEADER_HASH_AT..]);
    bytes
}

/// A file under construction; removed unless published.
struct Staging {
    path: PathBuf,
    published: bool,
}

impl Staging {
    fn beside(path: &Path) -> Self {
        temporary::remove_stale(path);
        let mut name = temporary::stem(path);
        name.push(temporary::SUFFIX);
        Self { path: path.with_file_name(name), published: false }
    }

    fn publish(mut self, path: &Path) -> Result<(), FormatError> {
        let io = |action| move |error| FormatError::Io { action, path: path.to_path_buf(), error };
        std::fs::rename(&self.path, path).map_err(io("cannot rename to"))?;
        self.published = true;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        File::open(folder).and_then(|folder| folder.sync_all()).map_err(io("cannot sync the folder of"))
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        if !self.published {
            // Nothing can be done about a failure here, and the error that led here matters more.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}
