//! The work file beside the output: every finished block, so that a killed bake can go on.
//!
//! A head names the bake by a hash of everything that decides its bytes. Records follow, each
//! with its length and BLAKE3; a record that is cut or damaged ends the journal there.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use relief_formats::file::Entry;
use relief_formats::tile_planes::EncodedTile;

use super::record;
use super::stage::{BlockKey, Finished};

const MAGIC: &[u8; 16] = b"relief-bake wk 2";
const HEAD_BYTES: u64 = 48;

/// A tile in the journal: its index entry, whose `offset` is the place in the journal.
pub type Placed = Entry;

/// An open work file.
pub struct Journal {
    path: PathBuf,
    file: File,
    end: u64,
    keep: bool,
}

/// A block found in a journal.
pub struct Restored {
    /// Which block.
    pub key: BlockKey,
    /// Its tiles' places.
    pub tiles: Vec<Placed>,
    /// Its summary and whether it has measured nodes.
    pub rest: record::Rest,
}

impl Journal {
    /// Starts a new work file, replacing any.
    pub fn create(path: &Path, identity: &[u8; 32]) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(path)?;
        // From here on an error takes the file away again.
        let mut journal = Self { path: path.to_path_buf(), file, end: HEAD_BYTES, keep: false };
        journal.file.write_all(MAGIC)?;
        journal.file.write_all(identity)?;
        Ok(journal)
    }

    /// Opens a work file and hands each whole record to `visit`. `None` when there is no work
    /// file of this bake.
    pub fn resume(path: &Path, identity: &[u8; 32], mut visit: impl FnMut(Restored)) -> io::Result<Option<Self>> {
        let mut file = match OpenOptions::new().read(true).write(true).open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other?,
        };
        let mut head = [0; HEAD_BYTES as usize];
        if file.read_exact(&mut head).is_err() || head[..16] != MAGIC[..] || head[16..] != identity[..] {
            return Ok(None);
        }
        let length = file.metadata()?.len();
        let mut end = HEAD_BYTES;
        while let Some((restored, next)) = read_record(&mut file, end, length)? {
            visit(restored);
            end = next;
        }
        file.set_len(end)?;
        file.seek(SeekFrom::Start(end))?;
        Ok(Some(Self { path: path.to_path_buf(), file, end, keep: false }))
    }

    /// Appends a finished block and returns its tiles' places.
    pub fn append(&mut self, key: BlockKey, finished: &Finished) -> io::Result<Vec<Placed>> {
        let payload = record::encode(key, finished);
        let placed = places(&finished.tiles, self.end + 8 + record::tile_bytes_at(&payload));
        self.file.write_all(&(payload.len() as u64).to_le_bytes())?;
        self.file.write_all(&payload)?;
        self.file.write_all(blake3::hash(&payload).as_bytes())?;
        self.end += 8 + payload.len() as u64 + 32;
        Ok(placed)
    }

    /// Appends a tile's planes to `buffer`.
    pub fn read(&self, tile: &Placed, buffer: &mut Vec<u8>) -> io::Result<()> {
        use std::os::unix::fs::FileExt as _;
        let start = buffer.len();
        buffer.resize(start + tile.bytes() as usize, 0);
        self.file.read_exact_at(&mut buffer[start..], tile.offset)
    }

    /// Keeps the work file when this is dropped: for an interrupted bake.
    pub fn keep(&mut self) {
        self.keep = true;
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        if !self.keep {
            // A work file that cannot be removed is in nobody's way; the bake itself has ended.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Index entries of tiles whose planes follow one another from `at` on.
fn places(tiles: &[EncodedTile], mut at: u64) -> Vec<Placed> {
    tiles
        .iter()
        .map(|tile| {
            let entry = Entry {
                key: tile.key,
                offset: at,
                lengths: std::array::from_fn(|k| tile.planes[k].len() as u32),
                min_q: tile.min_q,
                max_q: tile.max_q,
                digests: tile.digests,
            };
            at += entry.bytes();
            entry
        })
        .collect()
}

fn read_record(file: &mut File, at: u64, length: u64) -> io::Result<Option<(Restored, u64)>> {
    if length < at + 8 {
        return Ok(None);
    }
    file.seek(SeekFrom::Start(at))?;
    let mut size = [0; 8];
    file.read_exact(&mut size)?;
    let size = u64::from_le_bytes(size);
    if size > length || length - at - 8 < size.saturating_add(32) {
        return Ok(None);
    }
    let mut payload = vec![0; size as usize];
    let mut hash = [0; 32];
    file.read_exact(&mut payload)?;
    file.read_exact(&mut hash)?;
    if *blake3::hash(&payload).as_bytes() != hash {
        return Ok(None);
    }
    let Some((key, finished)) = record::decode(&payload) else { return Ok(None) };
    let tiles = places(&finished.tiles, at + 8 + record::tile_bytes_at(&payload));
    let rest = record::Rest { handoff: finished.handoff, measured: finished.measured };
    Ok(Some((Restored { key, tiles, rest }, at + 8 + size + 32)))
}
