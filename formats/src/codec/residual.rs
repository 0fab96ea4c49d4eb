//! A plane's residuals: contexts, scales, tokens.
//!
//! Each sample has an activity known to both sides before it is read. Its half-octave bucket is
//! mapped to a scale by a list at the start of the class, so the fixed tables adapt to any data.
//! Rows that repeat the row before, or one residual throughout, are only marked: seas, voids and
//! the padding of planes cost next to nothing.

use multiversion::multiversion;

use super::CodecError;
use super::bits::{BitReader, BitWriter};
use super::rans::{Decoder, Encoder, slot_base};
use super::rows::{Row, gather, put_rows, take_rows};
use super::samples;
use super::token::{EVEN_SCALE, SCALES, low_bits, table_of, tokenize, zigzag};

/// Buckets of activity; larger activities share the last.
pub const BUCKETS: usize = 48;

/// Half-octave buckets: 0 for 0, then by the exponent and the first mantissa bit of activity + 1.
#[multiversion(targets = "simd")]
pub fn buckets(activity: &[i32], out: &mut [u8]) {
    for (a, b) in activity.iter().zip(out) {
        let bits = ((a.saturating_add(1)) as f32).to_bits();
        *b = ((bits >> 22).saturating_sub(254)).min(BUCKETS as u32 - 1) as u8;
    }
}

/// The encoder's choice: the buckets in use, first and last, and the scale of each, such that the
/// mean |residual| of scale t is near 2^((t - 8) / 2). A reader takes whatever the plane says.
#[must_use]
pub fn choose_scales(bucket: &[u8], residual: &[i32]) -> (usize, usize, [u8; BUCKETS]) {
    let mut sum = [(0u64, 0u64, 0u32); BUCKETS];
    for (&b, &r) in bucket.iter().zip(residual) {
        let (total, count, largest) = &mut sum[b as usize];
        *total += u64::from(r.unsigned_abs());
        *count += 1;
        *largest = (*largest).max(zigzag(r));
    }
    let first = sum.iter().position(|s| s.1 > 0).unwrap_or(0);
    let last = sum.iter().rposition(|s| s.1 > 0).unwrap_or(0);
    let scale = sum.map(|(total, count, largest)| {
        let mean = (total as f64 / count.max(1) as f64).max(1e-9);
        // Even over eight values the mean is 2; a peaked spread that fits there has a smaller one.
        if largest < 8 && mean > 1.6 {
            EVEN_SCALE
        } else {
            (2.0 * mean.log2() + 8.0).round().clamp(0.0, f64::from(EVEN_SCALE) - 1.0) as u8
        }
    });
    (first, last, scale)
}

/// Set in a class's bucket count when row marks follow.
const MARKED: u8 = 0x80;

/// Writes a plane: its classes in order, then [`PlaneWriter::finish`].
#[derive(Default)]
pub struct PlaneWriter {
    header: Vec<u8>,
    rans: Encoder,
    raw: BitWriter,
    bucket: Vec<u8>,
}

impl PlaneWriter {
    /// Adds a class of residuals with their activities, in rows of `width` samples.
    pub fn class(&mut self, residual: &[i32], activity: &[i32], width: usize) {
        if residual.iter().all(|&r| r == 0) {
            self.header.extend([0, 0]);
            return;
        }
        let before = std::iter::once(None).chain(residual.chunks_exact(width).map(Some));
        let rows: Vec<Row> = residual.chunks_exact(width).zip(before).map(|(row, b)| Row::of(row, b)).collect();
        // Marks cost two bits a row: less than a row of any kind does.
        if rows.iter().any(|&row| row != Row::Whole) {
            let (r, a): (Vec<i32>, Vec<i32>) =
                (gather(&rows, residual, width).collect(), gather(&rows, activity, width).collect());
            self.samples(&r, &a, Some(&rows));
        } else {
            self.samples(residual, activity, None);
        }
    }

    fn samples(&mut self, residual: &[i32], activity: &[i32], rows: Option<&[Row]>) {
        self.bucket.resize(residual.len(), 0);
        buckets(activity, &mut self.bucket);
        let (first, last, scale) = choose_scales(&self.bucket, residual);
        let marked = if rows.is_some() { MARKED } else { 0 };
        self.header.extend([first as u8, (last - first + 1) as u8 | marked]);
        self.header.extend(&scale[first..=last]);
        put_rows(&mut self.header, rows.unwrap_or_default());
        self.rans.start_class(residual.len());
        for (&b, &r) in self.bucket.iter().zip(residual) {
            let t = scale[b as usize];
            let (token, raw, n) = tokenize(zigzag(r), t);
            self.rans.push(table_of(t), token);
            self.raw.put(raw, n);
        }
    }

    /// The plane's bytes: header length u16, word bytes u32, header, words, raw bits.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        if self.header.iter().all(|&b| b == 0) {
            return Vec::new();
        }
        let words = self.rans.finish();
        let raw = self.raw.finish();
        let mut bytes = Vec::with_capacity(6 + self.header.len() + words.len() + raw.len());
        bytes.extend_from_slice(&(self.header.len() as u16).to_le_bytes());
        bytes.extend_from_slice(&(words.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&self.header);
        bytes.extend_from_slice(&words);
        bytes.extend_from_slice(&raw);
        bytes
    }
}

/// Reads what [`PlaneWriter`] wrote. No bytes at all mean that every residual is zero.
pub struct PlaneReader<'a> {
    parts: Option<Parts<'a>>,
}

struct Parts<'a> {
    header: &'a [u8],
    rans: Decoder<'a>,
    raw: BitReader<'a>,
}

impl<'a> PlaneReader<'a> {
    /// A reader over a plane's bytes.
    pub fn new(bytes: &'a [u8]) -> Result<Self, CodecError> {
        let parts = if bytes.is_empty() {
            None
        } else {
            let (head, rest) = bytes.split_at_checked(6).ok_or(CodecError::Truncated)?;
            let header_len = usize::from(u16::from_le_bytes([head[0], head[1]]));
            let words_len = u32::from_le_bytes([head[2], head[3], head[4], head[5]]) as usize;
            let (header, rest) = rest.split_at_checked(header_len).ok_or(CodecError::Truncated)?;
            let (words, raw) = rest.split_at_checked(words_len).ok_or(CodecError::Truncated)?;
            Some(Parts { header, rans: Decoder::new(words)?, raw: BitReader::new(raw) })
        };
        Ok(Self { parts })
    }

    /// Reads a class in rows of `width`: `values` are its samples' activities, then their residuals.
    pub fn class(&mut self, values: &mut [i32], width: usize) -> Result<(), CodecError> {
        let Some(parts) = &mut self.parts else {
            values.fill(0);
            return Ok(());
        };
        let (&[first, count], rest) = parts.header.split_first_chunk().ok_or(CodecError::Truncated)?;
        let (marked, count) = (count & MARKED != 0, usize::from(count & !MARKED));
        let (scales, rest) = rest.split_at_checked(count).ok_or(CodecError::Truncated)?;
        parts.header = rest;
        if count == 0 {
            values.fill(0);
            return if marked { Err(CodecError::Range) } else { Ok(()) };
        }
        let first = usize::from(first);
        if first + count > BUCKETS || scales.iter().any(|&t| t as usize >= SCALES) {
            return Err(CodecError::Range);
        }
        // A bucket outside the list can only be met in a damaged plane; any scale does for it.
        let mut scale = [0u8; BUCKETS];
        scale[first..first + count].copy_from_slice(scales);
        let coding = scale.map(|t| slot_base(table_of(t)) | low_bits(t) << 16);
        if !marked {
            samples::read(&mut parts.rans, &mut parts.raw, &coding, values);
            return Ok(());
        }
        let rows = take_rows(&mut parts.header, values.len() / width)?;
        let mut stored: Vec<i32> = gather(&rows, values, width).collect();
        samples::read(&mut parts.rans, &mut parts.raw, &coding, &mut stored);
        let mut next = stored.as_slice();
        for (y, row) in rows.iter().enumerate() {
            let (before, here) = values.split_at_mut(y * width);
            let here = &mut here[..width];
            let (stored, rest) = next.split_at(row.stored(width));
            next = rest;
            match row {
                Row::Whole => here.copy_from_slice(stored),
                Row::Repeat => here.copy_from_slice(&before[(y - 1) * width..]),
                Row::Constant => here.fill(stored[0]),
            }
        }
        Ok(())
    }

    /// Checks that the plane ends with its last sample.
    pub fn finish(self) -> Result<(), CodecError> {
        let Some(parts) = self.parts else { return Ok(()) };
        if !parts.header.is_empty() {
            return Err(CodecError::Trailing);
        }
        parts.rans.finish()?;
        parts.raw.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn there_and_back(classes: &[(Vec<i32>, Vec<i32>)], width: usize) -> usize {
        let mut writer = PlaneWriter::default();
        for (residual, activity) in classes {
            writer.class(residual, activity, width);
        }
        let bytes = writer.finish();
        let mut reader = PlaneReader::new(&bytes).unwrap();
        for (residual, activity) in classes {
            let mut got = activity.clone();
            reader.class(&mut got, width).unwrap();
            assert_eq!(&got, residual);
        }
        assert_eq!(reader.finish(), Ok(()));
        bytes.len()
    }

    proptest! {
        #[test]
        fn round_trip(samples in prop::collection::vec((-(1i32 << 25)..1 << 25, 0u32..26, 0i32..1 << 28), 1..500), zero: bool) {
            let residual: Vec<i32> = samples.iter().map(|&(r, s, _)| if zero { 0 } else { r >> s }).collect();
            let activity: Vec<i32> = samples.iter().map(|&(_, s, a)| a >> s).collect();
            let width = residual.len();
            there_and_back(&[(residual.clone(), activity.clone()), (residual, activity)], width);
        }

        #[test]
        fn rows_of_every_kind(kinds in prop::collection::vec(0u8..4, 1..40), width in 1usize..30) {
            let mut residual = Vec::new();
            for (y, kind) in kinds.iter().enumerate() {
                let start = residual.len();
                for x in 0..width {
                    residual.push(match kind {
                        0 => (x * 37 + y * 11) as i32 % 50 - 20,
                        1 if y > 0 => residual[start - width + x],
                        2 => y as i32 - 7,
                        _ => 0,
                    });
                }
            }
            let activity: Vec<i32> = (0..residual.len() as i32).collect();
            there_and_back(&[(residual, activity)], width);
        }

        #[test]
        fn junk_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
            if let Ok(mut reader) = PlaneReader::new(&bytes) {
                let mut values: Vec<i32> = (0..300).map(|k| k * k).collect();
                let _ = reader.class(&mut values, 30);
                let _ = reader.finish();
            }
        }
    }

    #[test]
    fn repeated_rows_cost_their_marks() {
        let row: Vec<i32> = (0..128).map(|x| x * x % 91 - 40).collect();
        let one = there_and_back(&[(row.clone(), vec![5; 128])], 128);
        let all = there_and_back(&[(row.repeat(128), vec![5; 128 * 128])], 128);
        assert!(all <= one + 32 + 2, "{all} bytes against {one}");
    }

    #[test]
    fn buckets_are_half_octaves() {
        let activity = [0, 1, 2, 3, 4, 5, 6, 7, i32::MAX];
        let mut out = [0; 9];
        buckets(&activity, &mut out);
        assert_eq!(out, [0, 2, 3, 4, 4, 5, 5, 6, BUCKETS as u8 - 1]);
    }
}
