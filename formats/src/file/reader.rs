//! Opening a file and finding its parts. Nothing is decoded and nothing is allocated that the
//! file's own size does not pay for.

use std::fs::File;
use std::path::Path;

use memmap2::Mmap;

use super::header::HEADER_BYTES;
use super::index::ENTRY_BYTES;
use super::section::{INDEX, MAX_SECTIONS, MESH, META, ROW_BYTES, Section, TILES};
use super::writer::{TAIL_BYTES, tail_of};
use super::{Entry, FormatError, Header, Metadata, Plane};
use crate::body::Body;
use crate::grid::Grid;
use crate::mesh::{self, PatchMesh};
use crate::tile::TileKey;

/// An open file: its header and metadata are checked, its tiles are checked when they are read.
pub struct Relief {
    /// Dropped before the map is.
    _guard: Option<Box<dyn Send + Sync>>,
    map: Mmap,
    /// None for a copy in memory.
    file: Option<File>,
    header: Header,
    metadata: Metadata,
    sections: Vec<Section>,
    index: std::ops::Range<usize>,
    tiles: std::ops::Range<usize>,
}

impl Relief {
    /// Maps and checks a file: header, length, tail, section table, metadata.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        Self::open_guarded(path, |_, _| ())
    }

    /// The same for programs that outlive a cut of the file: `guard` is told of the mapped bytes and
    /// their file before anything is read, and what it returns lives as long as the map.
    pub fn open_guarded<G>(path: &Path, guard: impl FnOnce(&[u8], &File) -> G) -> Result<Self, FormatError>
    where
        G: Send + Sync + 'static,
    {
        let (map, file) = super::map::map(path)?;
        let guard: Option<Box<dyn Send + Sync>> = Some(Box::new(guard(&map, &file)));
        Ok(Self { _guard: guard, file: Some(file), ..Self::check(map)? })
    }

    /// Checks a file that is in memory already, and keeps a copy of it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FormatError> {
        Self::check(super::map::copy(bytes)?)
    }

    fn check(map: Mmap) -> Result<Self, FormatError> {
        let mut header = Header::decode(&map)?;
        if header.file_bytes != map.len() as u64 {
            return Err(FormatError::damaged(format!(
                "{} bytes long, its header says {}",
                map.len(),
                header.file_bytes
            )));
        }
        let rows = header.section_count as usize * ROW_BYTES;
        if header.section_count > MAX_SECTIONS || map.len() < HEADER_BYTES + rows + TAIL_BYTES {
            return Err(FormatError::damaged("no room for the sections that the header counts"));
        }
        let tail_at = map.len() - TAIL_BYTES;
        if map[tail_at..] != tail_of(&map[..HEADER_BYTES], header.file_bytes) {
            return Err(FormatError::damaged("the tail does not match the header"));
        }
        let table = &map[HEADER_BYTES..HEADER_BYTES + rows];
        if *blake3::hash(table).as_bytes() != header.table_hash {
            return Err(FormatError::damaged("the section table's checksum does not match"));
        }
        let sections = Section::decode_table(table, (HEADER_BYTES + rows) as u64, tail_at as u64)?;
        let find =
            |kind: [u8; 4]| {
                sections.iter().find(|s| s.kind == kind).map(range_of).ok_or_else(|| {
                    FormatError::damaged(format!("section {} is missing", String::from_utf8_lossy(&kind)))
                })
            };
        let (meta, index, tiles) = (find(META)?, find(INDEX)?, find(TILES)?);
        find(MESH)?;
        if index.len() as u64 != header.tile_count.saturating_mul(ENTRY_BYTES as u64) {
            return Err(FormatError::damaged("the index is not as long as the header counts"));
        }
        if meta.len() as u64 > Metadata::MAX_BYTES {
            return Err(FormatError::damaged("the metadata is larger than any can be"));
        }
        if sections.iter().any(|s| s.kind == META && *blake3::hash(&map[range_of(s)]).as_bytes() != s.hash) {
            return Err(FormatError::damaged("the metadata's checksum does not match"));
        }
        let metadata = Metadata::decode(&map[meta])?;
        adopt_names(&mut header.body, &metadata.body)?;
        Ok(Self { _guard: None, map, file: None, header, metadata, sections, index, tiles })
    }

    /// That the file was not cut since it was opened: reading what a cut took away ends the
    /// process. For programs that run long, before they read; costs a system call.
    ///
    /// # Errors
    /// [`FormatError::Damaged`] with the size that is left, or [`FormatError::Io`].
    pub fn check_whole(&self) -> Result<(), FormatError> {
        let Some(file) = &self.file else { return Ok(()) };
        let io = |error| FormatError::Io { action: "cannot read the size of", path: "the open file".into(), error };
        let bytes = file.metadata().map_err(io)?.len();
        match bytes < self.map.len() as u64 {
            true => {
                Err(FormatError::damaged(format!("cut to {bytes} of {} bytes since it was opened", self.map.len())))
            }
            false => Ok(()),
        }
    }

    /// The open file; none for a copy in memory.
    #[must_use]
    pub fn file(&self) -> Option<&File> {
        self.file.as_ref()
    }

    /// The header's numbers.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Where the heights come from.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The grid of nodes.
    #[must_use]
    pub fn grid(&self) -> Grid {
        self.header.grid()
    }

    /// What the heights stand on.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.header.body
    }

    /// Metres per step.
    #[must_use]
    pub fn step_m(&self) -> f64 {
        self.header.step_m()
    }

    /// The section table.
    #[must_use]
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// All bytes of the file.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.map
    }

    /// The bytes of the first section of a kind.
    #[must_use]
    pub fn section_bytes(&self, kind: [u8; 4]) -> Option<&[u8]> {
        self.sections.iter().find(|s| s.kind == kind).map(|s| &self.map[range_of(s)])
    }

    /// The patch mesh, its checksum and map exponent checked.
    pub fn patch_mesh(&self) -> Result<PatchMesh, FormatError> {
        let section = self.sections.iter().find(|s| s.kind == MESH);
        let section = section.ok_or_else(|| FormatError::damaged("section MESH is missing"))?;
        let bytes = &self.map[range_of(section)];
        if *blake3::hash(bytes).as_bytes() != section.hash {
            return Err(FormatError::damaged("the mesh's checksum does not match"));
        }
        let mesh = mesh::decode_section(bytes).map_err(|e| FormatError::damaged(e.to_string()))?;
        if mesh.m != self.header.m {
            return Err(FormatError::damaged(format!(
                "the mesh is for m = {}, the file has {}",
                mesh.m, self.header.m
            )));
        }
        Ok(mesh)
    }

    /// Number of tiles.
    #[must_use]
    pub fn tile_count(&self) -> usize {
        self.index.len() / ENTRY_BYTES
    }

    /// The n-th entry of the index: coarsest level first, then Morton order.
    pub fn entry(&self, n: usize) -> Result<Entry, FormatError> {
        let at = self.index.start + n * ENTRY_BYTES;
        Entry::decode(&self.map[at..at + ENTRY_BYTES], &self.grid(), self.tiles.len() as u64)
    }

    /// All entries.
    pub fn entries(&self) -> impl Iterator<Item = Result<Entry, FormatError>> + '_ {
        (0..self.tile_count()).map(|n| self.entry(n))
    }

    /// The entry of a tile, or none when the file has no such tile. Every entry on the way is
    /// checked, so a damaged one is an error and never looks like an absent tile.
    pub fn find(&self, key: TileKey) -> Result<Option<Entry>, FormatError> {
        if !self.grid().contains(key) {
            return Err(FormatError::Request(format!("no tile ({}, {}) at level {}", key.x, key.y, key.level)));
        }
        let wanted = Entry::sort_key(key);
        let (mut low, mut high) = (0, self.tile_count());
        while low < high {
            let middle = low.midpoint(high);
            let entry = self.entry(middle)?;
            match Entry::sort_key(entry.key).cmp(&wanted) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
                std::cmp::Ordering::Equal => return Ok(Some(entry)),
            }
        }
        Ok(None)
    }

    /// The encoded bytes of one plane of a tile.
    #[must_use]
    pub fn plane_bytes(&self, entry: &Entry, plane: Plane) -> &[u8] {
        let range = entry.range(plane);
        &self.map[self.tiles.start + range.start as usize..self.tiles.start + range.end as usize]
    }
}

fn range_of(section: &Section) -> std::ops::Range<usize> {
    section.offset as usize..(section.offset + section.length) as usize
}

/// Takes name and CRS from the metadata, after checking that its numbers are the header's.
fn adopt_names(header: &mut Body, metadata: &Body) -> Result<(), FormatError> {
    match (&mut *header, metadata) {
        (Body::Ellipsoid { name, a_m, b_m }, Body::Ellipsoid { name: n, a_m: a, b_m: b }) if a_m == a && b_m == b => {
            name.clone_from(n);
        }
        (Body::Plane { crs_wkt, x0, y0, dx, dy }, Body::Plane { crs_wkt: c, x0: x, y0: y, dx: u, dy: v })
            if (&*x0, &*y0, &*dx, &*dy) == (x, y, u, v) =>
        {
            crs_wkt.clone_from(c)
        }
        _ => return Err(FormatError::damaged("the metadata's body is not the header's")),
    }
    Ok(())
}
