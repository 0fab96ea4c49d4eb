//! The binary buffer with its views and accessors, and the file around it.

use serde_json::{Value, json};

use super::GlbError;

/// Bytes of the file's header and of each chunk's.
const FILE_HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const MAGIC: &[u8; 4] = b"glTF";
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// The binary buffer and what describes it.
#[derive(Default)]
pub(super) struct Parts {
    pub bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Parts {
    /// Appends bytes on a 4-byte boundary as a buffer view; returns its number.
    pub fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    pub fn accessor<const N: usize>(&mut self, values: &[[f32; N]], kind: &str) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let fold = |pick: fn(f32, f32) -> f32, start: f32| {
            let folded = values.iter().fold([start; N], |a, b| std::array::from_fn(|k| pick(a[k], b[k])));
            folded.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>() // exact as decimal text
        };
        let view = self.view(&bytes, Some(34962));
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind,
            "min": fold(f32::min, f32::INFINITY), "max": fold(f32::max, f32::NEG_INFINITY),
        }));
        self.accessors.len() - 1
    }

    pub fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(34963));
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR",
            "min": [indices.iter().min()], "max": [indices.iter().max()],
        }));
        self.accessors.len() - 1
    }
}

/// Header, JSON chunk padded with spaces, binary chunk padded with zeros.
pub(super) fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Result<Vec<u8>, GlbError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = FILE_HEADER + 2 * CHUNK_HEADER + json.len() + binary.len();
    let length = u32::try_from(total).map_err(|_| GlbError::TooLarge(total))?;
    let mut file = Vec::with_capacity(total);
    file.extend(MAGIC);
    file.extend(2u32.to_le_bytes());
    file.extend(length.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    Ok(file)
}
