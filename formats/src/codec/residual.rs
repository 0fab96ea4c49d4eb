//! A plane's residuals: contexts, scales, tokens.
//!
//! Each sample has an activity known to both sides before it is read. Its half-octave bucket is
//! mapped to a scale by a list at the start of the class, so the fixed tables adapt to any data.

use multiversion::multiversion;

use super::bits::{BitReader, BitWriter};
use super::rans::{Decoder, Encoder, slot_base};
use super::token::{
    ESCAPE, ESCAPE_BITS, SCALES, TOKENS, low_bits, table_of, token_range, tokenize, unzigzag, zigzag,
};
use super::CodecError;

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
    let mut sum = [(0u64, 0u64); BUCKETS];
    for (&b, &r) in bucket.iter().zip(residual) {
        let (total, count) = &mut sum[b as usize];
        *total += u64::from(r.unsigned_abs());
        *count += 1;
    }
    let first = sum.iter().position(|s| s.1 > 0).unwrap_or(0);
    let last = sum.iter().rposition(|s| s.1 > 0).unwrap_or(0);
    let scale = sum.map(|(total, count)| {
        let mean = (total as f64 / count.max(1) as f64).max(1e-9);
        (2.0 * mean.log2() + 8.0).round().clamp(0.0, SCALES as f64 - 1.0) as u8
    });
    (first, last, scale)
}

/// Writes a plane: its classes in order, then [`PlaneWriter::finish`].
#[derive(Default)]
pub struct PlaneWriter {
    header: Vec<u8>,
    rans: Encoder,
    raw: BitWriter,
    bucket: Vec<u8>,
}

impl PlaneWriter {
    /// Adds a class of residuals with their activities.
    pub fn class(&mut self, residual: &[i32], activity: &[i32]) {
        if residual.iter().all(|&r| r == 0) {
            self.header.extend([0, 0]);
            return;
        }
        self.bucket.resize(residual.len(), 0);
        buckets(activity, &mut self.bucket);
        let (first, last, scale) = choose_scales(&self.bucket, residual);
        self.header.extend([first as u8, (last - first + 1) as u8]);
        self.header.extend(&scale[first..=last]);
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
    bucket: Vec<u8>,
    base: Vec<u32>,
    token: Vec<u8>,
}

struct Parts<'a> {
    header: &'a [u8],
    rans: Decoder<'a>,
    raw: BitReader,
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
        Ok(Self { parts, bucket: Vec::new(), base: Vec::new(), token: Vec::new() })
    }

    /// Reads a class of `residual.len()` samples with the given activities.
    pub fn class(&mut self, activity: &[i32], residual: &mut [i32]) -> Result<(), CodecError> {
        let Some(parts) = &mut self.parts else {
            residual.fill(0);
            return Ok(());
        };
        let (&[first, count], rest) = parts.header.split_first_chunk().ok_or(CodecError::Truncated)?;
        let (scales, rest) = rest.split_at_checked(count as usize).ok_or(CodecError::Truncated)?;
        parts.header = rest;
        if count == 0 {
            residual.fill(0);
            return Ok(());
        }
        let (first, count) = (first as usize, count as usize);
        if first + count > BUCKETS || scales.iter().any(|&t| t as usize >= SCALES) {
            return Err(CodecError::Range);
        }
        // A bucket outside the list can only be met in a damaged plane; any scale does for it.
        let mut scale = [0u8; BUCKETS];
        scale[first..first + count].copy_from_slice(scales);
        let bases = scale.map(|t| slot_base(table_of(t)));
        let lows = scale.map(low_bits);

        self.bucket.resize(residual.len(), 0);
        self.base.resize(residual.len(), 0);
        self.token.resize(residual.len(), 0);
        buckets(activity, &mut self.bucket);
        for (base, &b) in self.base.iter_mut().zip(&self.bucket) {
            *base = bases[b as usize % BUCKETS];
        }
        parts.rans.class(&self.base, &mut self.token);
        for ((r, &token), &b) in residual.iter_mut().zip(&self.token).zip(&self.bucket) {
            let k = lows[b as usize % BUCKETS];
            let (base, n) = RANGES[token as usize % RANGES.len()];
            let z = if token == ESCAPE {
                parts.raw.get(ESCAPE_BITS)
            } else {
                (base << k) + parts.raw.get(n + k)
            };
            *r = unzigzag(z);
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

static RANGES: [(u32, u32); 64] = {
    let mut ranges = [(0, 0); 64];
    let mut token = 0;
    while token < TOKENS - 1 {
        ranges[token] = token_range(token as u8);
        token += 1;
    }
    ranges
};

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn round_trip(samples in prop::collection::vec((-(1i32 << 25)..1 << 25, 0u32..26, 0i32..1 << 28), 1..500), zero: bool) {
            let residual: Vec<i32> = samples.iter().map(|&(r, s, _)| if zero { 0 } else { r >> s }).collect();
            let activity: Vec<i32> = samples.iter().map(|&(_, s, a)| a >> s).collect();
            let mut writer = PlaneWriter::default();
            writer.class(&residual, &activity);
            writer.class(&residual, &activity);
            let bytes = writer.finish();
            let mut reader = PlaneReader::new(&bytes).unwrap();
            for _ in 0..2 {
                let mut got = vec![0; residual.len()];
                reader.class(&activity, &mut got).unwrap();
                prop_assert_eq!(&got, &residual);
            }
            prop_assert_eq!(reader.finish(), Ok(()));
        }

        #[test]
        fn junk_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
            if let Ok(mut reader) = PlaneReader::new(&bytes) {
                let activity: Vec<i32> = (0..300).map(|k| k * k).collect();
                let _ = reader.class(&activity, &mut vec![0; 300]);
                let _ = reader.finish();
            }
        }
    }

    #[test]
    fn buckets_are_half_octaves() {
        let activity = [0, 1, 2, 3, 4, 5, 6, 7, i32::MAX];
        let mut out = [0; 9];
        buckets(&activity, &mut out);
        assert_eq!(out, [0, 2, 3, 4, 4, 5, 5, 6, BUCKETS as u8 - 1]);
    }
}
