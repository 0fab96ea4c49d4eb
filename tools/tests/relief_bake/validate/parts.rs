//! A file's sections, to be changed and put together again with every checksum right.

use relief_formats::file::Header;
use relief_formats::file::header::HEADER_BYTES;
use relief_formats::file::section::{ROW_BYTES, Section};
use relief_formats::file::writer::{TAIL_BYTES, tail};

/// A file taken apart; `seal` puts it together with every checksum right again.
pub struct Parts {
    pub header: Header,
    pub sections: Vec<Section>,
    pub bodies: Vec<Vec<u8>>,
}

impl Parts {
    pub fn of(bytes: &[u8]) -> Self {
        let header = Header::decode(bytes).unwrap();
        let rows = header.section_count as usize * ROW_BYTES;
        let table = &bytes[HEADER_BYTES..HEADER_BYTES + rows];
        let end = (bytes.len() - TAIL_BYTES) as u64;
        let sections = Section::decode_table(table, (HEADER_BYTES + rows) as u64, end).unwrap();
        let bodies =
            sections.iter().map(|s| bytes[s.offset as usize..(s.offset + s.length) as usize].to_vec()).collect();
        Self { header, sections, bodies }
    }

    pub fn body(&mut self, kind: [u8; 4]) -> &mut Vec<u8> {
        let at = self.sections.iter().position(|section| section.kind == kind).unwrap();
        &mut self.bodies[at]
    }

    /// The bytes, with `odd(row)` as last word on the section table.
    pub fn seal_with(mut self, odd: impl Fn(&mut Vec<Section>), rows_odd: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
        let count = self.sections.len();
        let mut bytes = vec![0; HEADER_BYTES + count * ROW_BYTES];
        for (section, body) in self.sections.iter_mut().zip(&self.bodies) {
            bytes.resize(bytes.len().next_multiple_of(64), 0);
            section.offset = bytes.len() as u64;
            section.length = body.len() as u64;
            section.hash = *blake3::hash(body).as_bytes();
            bytes.extend_from_slice(body);
        }
        bytes.resize(bytes.len().next_multiple_of(64), 0);
        odd(&mut self.sections);
        let mut rows: Vec<u8> = self.sections.iter().flat_map(Section::encode).collect();
        rows_odd(&mut rows);
        self.header.section_count = self.sections.len() as u32;
        self.header.table_hash = *blake3::hash(&rows).as_bytes();
        self.header.file_bytes = (bytes.len() + TAIL_BYTES) as u64;
        bytes[HEADER_BYTES..HEADER_BYTES + rows.len()].copy_from_slice(&rows);
        bytes[..HEADER_BYTES].copy_from_slice(&self.header.encode());
        bytes.extend_from_slice(&tail(&self.header));
        bytes
    }

    pub fn seal(self) -> Vec<u8> {
        self.seal_with(|_| (), |_| ())
    }
}
